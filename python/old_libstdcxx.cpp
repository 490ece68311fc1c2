// What g++ since release 11 calls in libstdc++ and an older libstdc++ lacks; linked into the wheel's library.

#include <new>
#include <string>

namespace std {

void __throw_bad_array_new_length() { throw bad_array_new_length(); }

}  // namespace std
