// isym.hpp, and what a C++ exception in a callback does. ./wrapper quadruped.ply
#include <isym.hpp>

#include "test.h"

#include <algorithm>
#include <thread>

namespace {

struct Strange {
  int number;
};

template <typename Thrown, typename Call> Thrown thrown_by(Call call) {
  try {
    call();
  } catch (Thrown &thrown) {
    return thrown;
  }
  std::fprintf(stderr, "nothing was thrown (last error: %s)\n", isym_error_message());
  std::exit(1);
}

// Through the C functions alone: the exception is stopped at the border, with its text. A library that holds a C++ library
// of its own, as those of a release do, stops it too, and cannot read it.
#ifdef OTHER_CXX_LIBRARY
constexpr const char *PATIENCE = "an exception that is no std::exception";
#else
constexpr const char *PATIENCE = "the host is out of patience";
#endif

void exceptions_do_not_cross(const isym::Mesh &mesh) {
  isym::Options options;
  isym::Progress progress;
  isym_result *result = nullptr;
  const auto throws = [](const char *, double fraction, void *) -> std::int32_t {
    if (fraction > 0.2) {
      throw std::runtime_error("the host is out of patience");
    }
    return 0;
  };
  OK(isym_progress_set_callback(progress.get(), throws, nullptr));
  FAILS(ISYM_ERROR_CALLBACK, isym_mesh_detect(mesh.get(), options.get(), progress.get(), &result));
  EXPECT(std::string(isym_error_message()) == std::string("the progress callback threw: ") + PATIENCE);
  EXPECT(result == nullptr);

  isym::Progress strange;
  const auto throws_a_number = [](const char *, double, void *) -> std::int32_t { throw 7; };
  OK(isym_progress_set_callback(strange.get(), throws_a_number, nullptr));
  FAILS(ISYM_ERROR_CALLBACK, isym_mesh_detect(mesh.get(), options.get(), strange.get(), &result));
}

// Through the wrapper: the caller gets the very exception.
void exceptions_come_out_of_the_wrapper(const isym::Mesh &mesh) {
  const isym::Progress progress([](const char *, double) -> bool { throw Strange{42}; });
  EXPECT(thrown_by<Strange>([&] { mesh.detect(isym::Options(), progress); }).number == 42);
  const isym::Progress stopping([](const char *, double fraction) { return fraction < 0.3; });
  EXPECT(thrown_by<isym::Cancelled>([&] { mesh.detect(isym::Options(), stopping); }).status() ==
         ISYM_ERROR_CANCELLED);
}

void errors_are_exceptions() {
  EXPECT(thrown_by<isym::Error>([] { isym::Mesh::read("no/such/file.ply"); }).status() == ISYM_ERROR_FILE);
  EXPECT(thrown_by<isym::Error>([] { isym::Options().set("samples", 1); }).status() == ISYM_ERROR_OPTION);
  EXPECT(thrown_by<isym::Error>([] { isym::Mesh::from_triangles<double>({}, {}); }).status() == ISYM_ERROR_MESH);
}

void normal_use(const isym::Mesh &mesh) {
  isym::Options options;
  options.set("symmetries", 1).set_known_signs({}).set_model("");
  EXPECT(options.value("symmetries") == 1 && isym::option_specs().size() == isym_option_count());
  double last = 0;
  const isym::Progress progress([&](const char *, double fraction) {
    EXPECT(fraction >= last);
    last = fraction;
    return true;
  });
  const isym::Result result = mesh.detect(options, progress);
  EXPECT(progress.fraction() == 1 && result.symmetry_count() == 1 && result.summary().kind == ISYM_KIND_REFLECTION);
  EXPECT(!result.continuous_family() && result.outcome() == ISYM_OUTCOME_FOUND);
  const isym::Result doubtful = mesh.detect(isym::Options().set("plausibility", 100));
  EXPECT(doubtful.outcome() == ISYM_OUTCOME_DOUBTFUL && doubtful.symmetry_count() == 1);
  const std::size_t n = result.vertex_count();
  const auto partners = result.partners();
  const auto points = result.surface_points();
  EXPECT(partners.size() == n && points.corners.size() == 3 * n && result.curve().closed.size() >= 1);
  EXPECT(result.report().back() == '\n' && result.report().find("\"outcome\": \"found\"") != std::string::npos);

  const isym::Result stored =
      mesh.restore(ISYM_KIND_REFLECTION, partners, result.confidences(), result.sides(), points);
  const isym::Result again = mesh.detect_again(stored);
  EXPECT(again.partners() == partners && mesh.detect_again(again).partners() == partners);
  const auto positions = mesh.positions();
  const auto distances = result.curve_distances(positions);
  EXPECT(*std::min_element(distances.begin(), distances.end()) < 0.05);
  EXPECT(*std::max_element(distances.begin(), distances.end()) > 0.2);
  isym::Mirroring average;
  average.merge = ISYM_MERGE_AVERAGE;
  EXPECT(stored.symmetrize_positions(positions, average) == result.symmetrize_positions(positions, average));
  EXPECT(stored.carry_displacement(positions, positions, average) ==
         result.carry_displacement(positions, positions, average));
  const std::vector<double> ones(n, 1.0);
  EXPECT(result.mirror_values(ones, 1, average) == ones);
  const std::vector<std::uint8_t> all(n, 1);
  EXPECT(result.mirror_selection(all) == all);
  const std::vector<std::uint8_t> all_faces(mesh.size()[1], 1);
  EXPECT(result.mirror_face_selection(all_faces) == all_faces && result.pair_colours().size() == 3 * n);
  EXPECT(thrown_by<isym::Error>([&] { result.mirror_values(ones, 2, average); }).status() == ISYM_ERROR_LENGTH);
  EXPECT(mesh.eigen(6).functions.size() == 6 * n && mesh.connectivity_hash() != 0);
}

} // namespace

int main(int count, char **arguments) {
  EXPECT(count == 2);
  EXPECT(isym::version() == ISYM_VERSION);
  {
    const isym::Mesh mesh = isym::Mesh::read(arguments[1]);
    exceptions_do_not_cross(mesh);
    exceptions_come_out_of_the_wrapper(mesh);
    errors_are_exceptions();
    std::thread other([&] { normal_use(mesh); });
    other.join();
  }
  EXPECT(isym_handle_count() == 0);
  return 0;
}
