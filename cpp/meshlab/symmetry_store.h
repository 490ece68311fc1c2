// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetries kept with a MeshLab mesh: as custom attributes that users see and files carry, beside a hash of the
// connectivity that they belong to.
#ifndef INTRINSYM_MESHLAB_SYMMETRY_STORE_H
#define INTRINSYM_MESHLAB_SYMMETRY_STORE_H

#include "mesh_arrays.h"

#include <chrono>
#include <future>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

// Values of the library's options by name; those that are not named keep their defaults.
using OptionValues = std::vector<std::pair<std::string, double>>;

// What `call` makes of a progress. It runs in a thread of its own; the host's bar is told in this one, twenty times a second, so that the
// host lives on through a long stage. The host may cancel, which throws isym::Cancelled out of the call.
template <typename Call> auto beside_host(vcg::CallBackPos *callback, const Call &call) {
  std::mutex mutex;
  std::string stage = "mesh";
  const isym::Progress progress([&](const char *name, double) {
    const std::lock_guard<std::mutex> lock(mutex);
    stage = name;
    return true;
  });
  const auto tell = [&] {
    std::unique_lock<std::mutex> lock(mutex);
    const std::string text = "Intrinsic symmetry: " + stage;
    lock.unlock();
    return callback == nullptr || callback(static_cast<int>(100 * progress.fraction()), text.c_str());
  };
  auto answer = std::async(std::launch::async, [&] { return call(progress); });
  do {
    if (!tell()) {
      progress.cancel();
    }
  } while (answer.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready);
  tell();
  return answer.get();
}

// The custom attributes of symmetry `index` (from 0): name, and "_2", "_3", ... from the second one on.
std::string attribute_name(const char *name, std::size_t index);

// Keeps all symmetries of a result, and how they were found, with the mesh; whatever was kept before is gone.
// One value per vertex: sym_vertex (partner), sym_confidence, sym_side, sym_face; three: sym_corners (vertices of
// that face) and sym_barycentrics, the exact mirror image. Indices count what is not deleted; -1 is none.
void keep_symmetries(CMeshO &mesh, const MeshArrays &arrays, const isym::Mesh &validated, const isym::Result &result,
                     const OptionValues &options);

void forget_symmetries(CMeshO &mesh);

// A symmetry that fits the mesh as it is now.
struct FittingSymmetry {
  isym::Result result;
  // In the result.
  std::size_t index;
  // Whether it was found again, because the mesh had none or had changed.
  bool recomputed;
};

// Symmetry `index` (from 0) of the mesh: the kept one, or a new one as the last was found, which is kept.
// Throws MLException if there is none.
FittingSymmetry fitting_symmetry(CMeshO &mesh, const MeshArrays &arrays, const isym::Mesh &validated,
                                 std::size_t index, vcg::CallBackPos *callback);

// Finds symmetries.
isym::Result detect(const isym::Mesh &validated, const OptionValues &options, vcg::CallBackPos *callback);

#endif
