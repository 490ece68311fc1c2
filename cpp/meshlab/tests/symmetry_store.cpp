// SPDX-License-Identifier: GPL-3.0-or-later
// Kept maps on meshes with deleted elements, stale maps, and the host's progress bar. ./symmetry_store quadruped.ply
#include "../symmetry_store.h"

#include <common/mlexception.h>

#include "test.h"

#include <string>

namespace {

using Allocator = vcg::tri::Allocator<CMeshO>;

// Percentages that the host was told, and when it cancels.
std::vector<int> told;
int cancel_at = 101;

bool host_bar(const int percentage, const char *text) {
  EXPECT(std::string(text).rfind("Intrinsic symmetry: ", 0) == 0);
  told.push_back(percentage);
  return percentage < cancel_at;
}

// The mesh of a file, with a deleted vertex before every tenth vertex and a deleted face before every tenth face.
CMeshO with_deleted_elements(const isym::Mesh &file) {
  const auto [vertices, faces, corner_count] = file.size();
  std::vector<std::uint32_t> offsets(faces + 1), corners(corner_count);
  isym::check(isym_mesh_polygons(file.get(), offsets.data(), offsets.size(), corners.data(), corners.size()));
  const std::vector<double> positions = file.positions();
  CMeshO mesh;
  std::vector<std::size_t> place;
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    if (vertex % 10 == 0) {
      Allocator::DeleteVertex(mesh, *Allocator::AddVertex(mesh, Point3m(9, 9, 9)));
    }
    place.push_back(mesh.vert.size());
    const double *at = &positions[3 * vertex];
    Allocator::AddVertex(mesh, Point3m(Scalarm(at[0]), Scalarm(at[1]), Scalarm(at[2])));
  }
  for (std::size_t face = 0; face < faces; ++face) {
    const std::uint32_t *of = &corners[3 * face];
    if (face % 10 == 0) {
      Allocator::DeleteFace(mesh, *Allocator::AddFace(mesh, place[of[1]], place[of[0]], place[of[2]]));
    }
    Allocator::AddFace(mesh, place[of[0]], place[of[1]], place[of[2]]);
  }
  return mesh;
}

void expect_same(const isym::Result &first, const isym::Result &second, std::size_t index) {
  EXPECT(first.partners(index) == second.partners());
  EXPECT(first.confidences(index) == second.confidences());
  EXPECT(first.sides(index) == second.sides());
  EXPECT(first.surface_points(index).faces == second.surface_points().faces);
  EXPECT(first.surface_points(index).corners == second.surface_points().corners);
  EXPECT(first.surface_points(index).barycentrics == second.surface_points().barycentrics);
}

void a_kept_map_is_the_found_one_and_stale_ones_are_found_again(const char *path) {
  const isym::Mesh file = isym::Mesh::read(path);
  const isym::Result direct = file.detect();
  CMeshO mesh = with_deleted_elements(file);
  {
    const MeshArrays arrays(mesh);
    const isym::Mesh validated = arrays.validated();
    EXPECT(validated.connectivity_hash() == file.connectivity_hash());
    FittingSymmetry fresh = fitting_symmetry(mesh, arrays, validated, 0, host_bar);
    EXPECT(fresh.recomputed);
    expect_same(fresh.result, direct, fresh.index);
    EXPECT(told.size() > 1 && told.front() >= 0 && told.back() == 100);
    EXPECT(std::is_sorted(told.begin(), told.end()));
    FittingSymmetry kept = fitting_symmetry(mesh, arrays, validated, 0, nullptr);
    EXPECT(!kept.recomputed);
    expect_same(kept.result, direct, kept.index);
  }
  // What MeshLab does before it saves changes places, not numbers.
  Allocator::CompactEveryVector(mesh);
  {
    const MeshArrays arrays(mesh);
    const FittingSymmetry kept = fitting_symmetry(mesh, arrays, arrays.validated(), 0, nullptr);
    EXPECT(!kept.recomputed);
    expect_same(kept.result, direct, kept.index);
  }
  Allocator::DeleteFace(mesh, mesh.face[100]);
  const MeshArrays arrays(mesh);
  EXPECT(fitting_symmetry(mesh, arrays, arrays.validated(), 0, nullptr).recomputed);
}

void the_host_can_cancel_and_nothing_is_kept(const char *path) {
  CMeshO mesh = with_deleted_elements(isym::Mesh::read(path));
  const MeshArrays arrays(mesh);
  cancel_at = 0;
  try {
    fitting_symmetry(mesh, arrays, arrays.validated(), 0, host_bar);
    EXPECT(!"it was not cancelled");
  } catch (const isym::Cancelled &) {
  }
  EXPECT(!vcg::tri::HasPerVertexAttribute(mesh, "sym_vertex"));
}

} // namespace

int main(int count, char **arguments) {
  EXPECT(count == 2);
  a_kept_map_is_the_found_one_and_stale_ones_are_found_again(arguments[1]);
  the_host_can_cancel_and_nothing_is_kept(arguments[1]);
}
