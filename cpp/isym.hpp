// Intrinsym for C++17: isym.h with handles that free themselves, vectors, and exceptions.
//
// Everything is in the namespace isym. Functions throw isym::Error with the library's status and text. A progress
// callback may throw whatever it likes: the call is cancelled, and the exception comes out of it unchanged.
// Objects can be moved, not copied; const member functions may be called from several threads at once.

#ifndef INTRINSYM_ISYM_HPP
#define INTRINSYM_ISYM_HPP

#include <isym.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace isym {

// What went wrong: the status of isym.h, and its text.
class Error : public std::runtime_error {
public:
  Error(isym_status status, const std::string &text) : std::runtime_error(text), status_(status) {}
  isym_status status() const noexcept { return status_; }

private:
  isym_status status_;
};

// The call was cancelled.
class Cancelled : public Error {
public:
  using Error::Error;
};

inline void check(isym_status status) {
  if (status == ISYM_OK) {
    return;
  }
  const std::string text = isym_error_message();
  if (status == ISYM_ERROR_CANCELLED) {
    throw Cancelled(status, text);
  }
  throw Error(status, text);
}

// A handle that is freed with its owner.
template <typename Handle, isym_status (*Free)(Handle *)> struct Freed {
  void operator()(Handle *handle) const noexcept { Free(handle); }
};
template <typename Handle, isym_status (*Free)(Handle *)>
using Owned = std::unique_ptr<Handle, Freed<Handle, Free>>;

// The version of the library that is running.
inline std::string version() { return isym_version(); }

// Options by name; see option_specs() for the names and ranges.
class Options {
public:
  Options() {
    isym_options *handle = nullptr;
    check(isym_options_new(&handle));
    handle_.reset(handle);
  }
  Options &set(const std::string &name, double value) {
    check(isym_options_set(get(), name.c_str(), value));
    return *this;
  }
  Options &set_model(const std::string &path) {
    check(isym_options_set_model(get(), path.c_str()));
    return *this;
  }
  // 1 even, -1 odd, 0 unknown, from the first eigenfunction on.
  Options &set_known_signs(const std::vector<std::int8_t> &signs) {
    const std::int8_t none = 0;
    check(isym_options_set_known_signs(get(), signs.empty() ? &none : signs.data(), signs.size()));
    return *this;
  }
  double value(const std::string &name) const {
    double value = 0;
    check(isym_options_get(get(), name.c_str(), &value));
    return value;
  }
  isym_options *get() const noexcept { return handle_.get(); }

private:
  Owned<isym_options, isym_options_free> handle_;
};

inline std::vector<isym_option_spec> option_specs() {
  std::vector<isym_option_spec> specs(isym_option_count());
  for (std::size_t index = 0; index < specs.size(); ++index) {
    specs[index].size = sizeof specs[index];
    check(isym_option_describe(index, &specs[index]));
  }
  return specs;
}

// Progress of one call, and the way to cancel it from any thread.
class Progress {
public:
  // Stage, and the fraction of the call that is done; answer false to cancel.
  using Callback = std::function<bool(const char *, double)>;

  Progress() {
    isym_progress *handle = nullptr;
    check(isym_progress_new(&handle));
    handle_.reset(handle);
  }
  explicit Progress(Callback callback) : Progress() {
    state_ = std::make_unique<State>(State{std::move(callback), nullptr});
    check(isym_progress_set_callback(get(), &Progress::call, state_.get()));
  }
  void cancel() const { check(isym_progress_cancel(get())); }
  double fraction() const {
    double fraction = 0;
    check(isym_progress_fraction(get(), &fraction));
    return fraction;
  }
  // As isym::check; an exception of the callback comes out instead of the status that it caused.
  void check_call(isym_status status) const {
    if (state_ && state_->thrown) {
      std::rethrow_exception(std::exchange(state_->thrown, nullptr));
    }
    check(status);
  }
  isym_progress *get() const noexcept { return handle_.get(); }

private:
  struct State {
    Callback callback;
    std::exception_ptr thrown;
  };
  static std::int32_t call(const char *stage, double fraction, void *user_data) noexcept {
    State &state = *static_cast<State *>(user_data);
    try {
      return state.callback(stage, fraction) ? 0 : 1;
    } catch (...) {
      state.thrown = std::current_exception();
      return 1;
    }
  }
  std::unique_ptr<State> state_;
  Owned<isym_progress, isym_progress_free> handle_;
};

// How mirrored values meet the old ones; see isym_mirroring.
struct Mirroring {
  isym_merge merge = ISYM_MERGE_SWAP;
  float minimum_confidence = 0;
  bool weight_by_confidence = false;
  isym_mirroring c() const { return {sizeof(isym_mirroring), merge, minimum_confidence, weight_by_confidence ? 1 : 0}; }
};

// Lowest eigenpairs of the Laplace-Beltrami operator; see isym_eigen_read.
struct Eigenpairs {
  std::vector<double> values;    // count
  std::vector<double> functions; // vertices x count, those of one vertex side by side
  std::vector<double> mass;      // vertices
};

// Mirror images as points of the surface; see isym_result_surface_points.
struct SurfacePoints {
  std::vector<std::uint32_t> faces;   // vertices
  std::vector<std::uint32_t> corners; // 3 * vertices
  std::vector<float> barycentrics;    // 3 * vertices
};

// The fixed curve as lines; see isym_result_curve.
struct Curve {
  std::vector<std::uint32_t> line_offsets; // lines + 1
  std::vector<std::uint8_t> closed;        // lines
  std::vector<std::uint32_t> edges;        // 2 * points
  std::vector<float> parameters;           // points
};

// Throws what the library would say of arrays that do not fit, before it reads past one.
inline void expect_size(std::size_t found, std::size_t needed, const char *name) {
  if (found != needed) {
    throw Error(ISYM_ERROR_LENGTH, std::string(name) + " has " + std::to_string(found) + " elements, " +
                                       std::to_string(needed) + " are needed");
  }
}

// What was found on a mesh: symmetries by index, the best first.
class Result {
public:
  Result(isym_result *handle, std::size_t vertex_count) : handle_(handle), vertex_count_(vertex_count) {}

  // An ISYM_OUTCOME_ constant: found, doubtful or none.
  isym_outcome outcome() const {
    isym_outcome outcome = ISYM_OUTCOME_NONE;
    check(isym_result_outcome(get(), &outcome));
    return outcome;
  }
  // A doubtful one counts.
  std::size_t symmetry_count() const {
    std::size_t count = 0;
    check(isym_result_symmetry_count(get(), &count));
    return count;
  }
  // Whether the symmetries found are arbitrary ones of infinitely many, as those of a sphere or a vase are.
  bool continuous_family() const {
    std::uint8_t continuous = 0;
    check(isym_result_continuous_family(get(), &continuous));
    return continuous != 0;
  }
  std::size_t vertex_count() const noexcept { return vertex_count_; }
  isym_summary summary(std::size_t symmetry = 0) const {
    isym_summary summary{};
    summary.size = sizeof summary;
    check(isym_result_summary(get(), symmetry, &summary));
    return summary;
  }
  // ISYM_NONE for a vertex without partner.
  std::vector<std::uint32_t> partners(std::size_t symmetry = 0) const {
    std::vector<std::uint32_t> values(vertex_count_);
    check(isym_result_partners(get(), symmetry, values.data(), values.size()));
    return values;
  }
  std::vector<float> confidences(std::size_t symmetry = 0) const {
    std::vector<float> values(vertex_count_);
    check(isym_result_confidences(get(), symmetry, values.data(), values.size()));
    return values;
  }
  std::vector<std::int8_t> sides(std::size_t symmetry = 0) const {
    std::vector<std::int8_t> values(vertex_count_);
    check(isym_result_sides(get(), symmetry, values.data(), values.size()));
    return values;
  }
  SurfacePoints surface_points(std::size_t symmetry = 0) const {
    SurfacePoints points{std::vector<std::uint32_t>(vertex_count_), std::vector<std::uint32_t>(3 * vertex_count_),
                         std::vector<float>(3 * vertex_count_)};
    check(isym_result_surface_points(get(), symmetry, points.faces.data(), points.corners.data(),
                                     points.barycentrics.data(), vertex_count_));
    return points;
  }
  // Red, green, blue of each vertex: partners share a colour.
  std::vector<std::uint8_t> pair_colours(std::size_t symmetry = 0) const {
    std::vector<std::uint8_t> colours(3 * vertex_count_);
    check(isym_result_pair_colours(get(), symmetry, colours.data(), vertex_count_));
    return colours;
  }
  Curve curve(std::size_t symmetry = 0) const {
    std::size_t lines = 0, points = 0;
    check(isym_result_curve_size(get(), symmetry, &lines, &points));
    Curve curve{std::vector<std::uint32_t>(lines + 1), std::vector<std::uint8_t>(lines),
                std::vector<std::uint32_t>(2 * points), std::vector<float>(points)};
    if (lines > 0) {
      check(isym_result_curve(get(), symmetry, curve.line_offsets.data(), curve.closed.data(), lines,
                              curve.edges.data(), curve.parameters.data(), points));
    }
    return curve;
  }
  // JSON.
  std::string report() const {
    std::size_t size = 0;
    check(isym_result_report_size(get(), &size));
    std::string report(size, '\0');
    check(isym_result_report(get(), report.data(), size));
    report.pop_back();
    return report;
  }

  // One byte per vertex, 0 or 1.
  std::vector<std::uint8_t> mirror_selection(const std::vector<std::uint8_t> &selected, float minimum_confidence = 0,
                                             std::size_t symmetry = 0) const {
    std::vector<std::uint8_t> mirrored(selected.size());
    expect_size(selected.size(), vertex_count_, "selected");
    check(isym_result_mirror_selection(get(), symmetry, selected.data(), minimum_confidence, mirrored.data(),
                                       vertex_count_));
    return mirrored;
  }
  // One byte per face, 0 or 1.
  std::vector<std::uint8_t> mirror_face_selection(const std::vector<std::uint8_t> &selected,
                                                  float minimum_confidence = 0, std::size_t symmetry = 0) const {
    static std::uint8_t none = 0;
    const bool empty = selected.empty();
    std::vector<std::uint8_t> mirrored(selected.size());
    check(isym_result_mirror_face_selection(get(), symmetry, empty ? &none : selected.data(), minimum_confidence,
                                            empty ? &none : mirrored.data(), selected.size()));
    return mirrored;
  }
  // `components` numbers per vertex.
  std::vector<double> mirror_values(const std::vector<double> &values, std::size_t components,
                                    const Mirroring &mirroring, std::size_t symmetry = 0) const {
    const isym_mirroring how = mirroring.c();
    std::vector<double> mirrored(values.size());
    expect_size(values.size(), components * vertex_count_, "values");
    check(isym_result_mirror_values(get(), symmetry, &how, values.data(), components, mirrored.data(), vertex_count_));
    return mirrored;
  }
  // x, y, z of each vertex.
  std::vector<double> carry_displacement(const std::vector<double> &positions,
                                         const std::vector<double> &displacements, const Mirroring &mirroring,
                                         std::size_t symmetry = 0) const {
    const isym_mirroring how = mirroring.c();
    expect_size(positions.size(), 3 * vertex_count_, "positions");
    expect_size(displacements.size(), 3 * vertex_count_, "displacements");
    std::vector<double> carried(displacements.size());
    check(isym_result_carry_displacement(get(), symmetry, &how, positions.data(), displacements.data(),
                                         carried.data(), vertex_count_));
    return carried;
  }
  // x, y, z of each vertex.
  std::vector<double> symmetrize_positions(const std::vector<double> &positions, const Mirroring &mirroring,
                                           const Progress &progress = Progress(), std::size_t symmetry = 0) const {
    const isym_mirroring how = mirroring.c();
    expect_size(positions.size(), 3 * vertex_count_, "positions");
    std::vector<double> moved(positions.size());
    progress.check_call(isym_result_symmetrize_positions(get(), symmetry, &how, positions.data(), progress.get(),
                                                         moved.data(), vertex_count_));
    return moved;
  }
  // Of each vertex, along the surface; infinite where the curve cannot be reached.
  std::vector<double> curve_distances(const std::vector<double> &positions, std::size_t symmetry = 0) const {
    expect_size(positions.size(), 3 * vertex_count_, "positions");
    std::vector<double> distances(vertex_count_);
    check(isym_result_curve_distances(get(), symmetry, positions.data(), distances.data(), vertex_count_));
    return distances;
  }
  isym_result *get() const noexcept { return handle_.get(); }

private:
  Owned<isym_result, isym_result_free> handle_;
  std::size_t vertex_count_;
};

// A validated mesh that never changes.
class Mesh {
public:
  // x, y, z of each vertex; three vertex numbers for each triangle.
  template <typename Real>
  static Mesh from_triangles(const std::vector<Real> &positions, const std::vector<std::uint32_t> &triangles) {
    isym_mesh *handle = nullptr;
    if constexpr (std::is_same_v<Real, float>) {
      check(isym_mesh_from_triangles_f32(pointer(positions), positions.size() / 3, pointer(triangles),
                                         triangles.size() / 3, &handle));
    } else {
      check(isym_mesh_from_triangles(pointer(positions), positions.size() / 3, pointer(triangles),
                                     triangles.size() / 3, &handle));
    }
    return Mesh(handle);
  }
  // Face f has the corners face_offsets[f] to before face_offsets[f + 1].
  template <typename Real>
  static Mesh from_polygons(const std::vector<Real> &positions, const std::vector<std::uint32_t> &face_offsets,
                            const std::vector<std::uint32_t> &corners) {
    isym_mesh *handle = nullptr;
    const std::size_t vertices = positions.size() / 3, faces = face_offsets.empty() ? 0 : face_offsets.size() - 1;
    if constexpr (std::is_same_v<Real, float>) {
      check(isym_mesh_from_polygons_f32(pointer(positions), vertices, pointer(face_offsets), faces,
                                        pointer(corners), corners.size(), &handle));
    } else {
      check(isym_mesh_from_polygons(pointer(positions), vertices, pointer(face_offsets), faces, pointer(corners),
                                    corners.size(), &handle));
    }
    return Mesh(handle);
  }
  static Mesh read(const std::string &path) {
    isym_mesh *handle = nullptr;
    check(isym_mesh_read(path.c_str(), &handle));
    return Mesh(handle);
  }

  // Vertices, faces and face corners.
  std::array<std::size_t, 3> size() const {
    std::array<std::size_t, 3> size{};
    check(isym_mesh_size(get(), &size[0], &size[1], &size[2]));
    return size;
  }
  std::vector<double> positions() const {
    std::vector<double> positions(3 * size()[0]);
    check(isym_mesh_positions(get(), positions.data(), positions.size()));
    return positions;
  }
  std::uint64_t connectivity_hash() const {
    std::uint64_t hash = 0;
    check(isym_mesh_connectivity_hash(get(), &hash));
    return hash;
  }
  Result detect(const Options &options = Options(), const Progress &progress = Progress()) const {
    isym_result *result = nullptr;
    progress.check_call(isym_mesh_detect(get(), options.get(), progress.get(), &result));
    return Result(result, size()[0]);
  }
  // Starts from an earlier result on the same connectivity: see isym_mesh_detect_again. Quickest from the newest or the
  // first, which hold what the call needs of the connectivity; a restored one does not.
  Result detect_again(const Result &previous, const Options &options = Options(),
                      const Progress &progress = Progress()) const {
    isym_result *result = nullptr;
    progress.check_call(isym_mesh_detect_again(get(), previous.get(), options.get(), progress.get(), &result));
    return Result(result, size()[0]);
  }
  Eigenpairs eigen(std::size_t count, const Progress &progress = Progress()) const {
    isym_eigen *handle = nullptr;
    progress.check_call(isym_mesh_eigen(get(), count, progress.get(), &handle));
    const Owned<isym_eigen, isym_eigen_free> owner(handle);
    std::size_t vertices = 0, found = 0;
    check(isym_eigen_size(handle, &vertices, &found));
    Eigenpairs pairs{std::vector<double>(found), std::vector<double>(vertices * found), std::vector<double>(vertices)};
    check(isym_eigen_read(handle, pairs.values.data(), pairs.functions.data(), pairs.mass.data(), vertices, found));
    return pairs;
  }
  // A result from stored arrays; see isym_result_restore.
  Result restore(isym_kind kind, const std::vector<std::uint32_t> &partners, const std::vector<float> &confidences,
                 const std::vector<std::int8_t> &sides, const SurfacePoints &points) const {
    const std::size_t vertices = size()[0];
    expect_size(partners.size(), vertices, "partners");
    expect_size(confidences.size(), vertices, "confidences");
    expect_size(sides.size(), vertices, "sides");
    expect_size(points.faces.size(), vertices, "faces");
    expect_size(points.corners.size(), 3 * vertices, "corners");
    expect_size(points.barycentrics.size(), 3 * vertices, "barycentrics");
    isym_result *result = nullptr;
    check(isym_result_restore(get(), kind, partners.data(), confidences.data(), sides.data(), points.faces.data(),
                              points.corners.data(), points.barycentrics.data(), vertices, &result));
    return Result(result, vertices);
  }
  isym_mesh *get() const noexcept { return handle_.get(); }

private:
  explicit Mesh(isym_mesh *handle) : handle_(handle) {}
  // An empty vector's pointer may be NULL, which the library takes for a mistake.
  template <typename Value> static const Value *pointer(const std::vector<Value> &values) noexcept {
    static const Value none{};
    return values.empty() ? &none : values.data();
  }
  Owned<isym_mesh, isym_mesh_free> handle_;
};

} // namespace isym

#endif // INTRINSYM_ISYM_HPP
