// Calls a host's progress callback so that no C++ exception of it reaches Rust, which could not stop one.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>

namespace {

// Copies as much of the text as fits, with its end.
void copy_text(const char *text, char *into, std::size_t capacity) noexcept {
  const std::size_t length = std::strlen(text);
  const std::size_t copied = length < capacity ? length : capacity - 1;
  std::memcpy(into, text, copied);
  into[copied] = '\0';
}

} // namespace

// 0: go on, 1: the callback asks to stop, 2: it threw, and `what` (of `capacity` > 0 bytes) says what.
extern "C" std::int32_t intrinsym_call_progress(std::int32_t (*callback)(const char *, double, void *),
                                                const char *stage, double fraction, void *user_data,
                                                char *what, std::size_t capacity) noexcept {
  try {
    return callback(stage, fraction, user_data) != 0 ? 1 : 0;
  } catch (const std::exception &error) {
    copy_text(error.what(), what, capacity);
  } catch (...) {
    copy_text("an exception that is no std::exception", what, capacity);
  }
  return 2;
}
