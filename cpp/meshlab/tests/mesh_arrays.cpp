// SPDX-License-Identifier: GPL-3.0-or-later
// What PyMeshLab cannot make: deleted elements, and faux edges that are no polygons.
#include "../mesh_arrays.h"

#include <common/mlexception.h>

#include "test.h"

namespace {

using Allocator = vcg::tri::Allocator<CMeshO>;
using Indices = std::vector<std::uint32_t>;

// Four squares in a row, each of two triangles that share a faux edge; vertices 0..4 below, 5..9 above.
CMeshO squares() {
  CMeshO mesh;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 5; ++column) {
      Allocator::AddVertex(mesh, Point3m(Scalarm(column), Scalarm(row), 0));
    }
  }
  for (int column = 0; column < 4; ++column) {
    Allocator::AddFace(mesh, column, column + 1, column + 6)->SetF(2);
    Allocator::AddFace(mesh, column, column + 6, column + 5)->SetF(0);
  }
  return mesh;
}

std::pair<Indices, Indices> polygons_of(const MeshArrays &arrays) {
  std::size_t vertices = 0, faces = 0, corners = 0;
  const isym::Mesh validated = arrays.validated();
  isym::check(isym_mesh_size(validated.get(), &vertices, &faces, &corners));
  Indices offsets(faces + 1), points(corners);
  isym::check(isym_mesh_polygons(validated.get(), offsets.data(), offsets.size(), points.data(), corners));
  return {offsets, points};
}

void faux_edges_join_triangles() {
  const CMeshO mesh = squares();
  const MeshArrays arrays(mesh);
  const auto [offsets, corners] = polygons_of(arrays);
  EXPECT((offsets == Indices{0, 4, 8, 12, 16}));
  EXPECT((corners == Indices{0, 1, 6, 5, 1, 2, 7, 6, 2, 3, 8, 7, 3, 4, 9, 8}));
  EXPECT((arrays.polygon_of_face() == Indices{0, 0, 1, 1, 2, 2, 3, 3}));
  EXPECT((arrays.face_of_polygon() == Indices{0, 2, 4, 6}));
}

void deleted_elements_do_not_count() {
  CMeshO mesh = squares();
  Allocator::DeleteFace(mesh, mesh.face[0]);
  Allocator::DeleteFace(mesh, mesh.face[1]);
  Allocator::DeleteVertex(mesh, mesh.vert[0]);
  Allocator::DeleteVertex(mesh, mesh.vert[5]);
  const MeshArrays arrays(mesh);
  EXPECT((arrays.vertices() == std::vector<std::size_t>{1, 2, 3, 4, 6, 7, 8, 9}));
  EXPECT((arrays.faces() == std::vector<std::size_t>{2, 3, 4, 5, 6, 7}));
  EXPECT((polygons_of(arrays).second == Indices{0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6}));
  EXPECT(arrays.positions()[0] == 1 && arrays.positions()[12] == 1 && arrays.positions()[13] == 1);
  // A kept map's hash does not change when MeshLab throws the deleted elements away.
  const auto hash = arrays.validated().connectivity_hash();
  Allocator::CompactEveryVector(mesh);
  EXPECT(MeshArrays(mesh).validated().connectivity_hash() == hash);
}

void faux_edges_that_make_no_polygon_are_ignored() {
  CMeshO half = squares();
  half.face[1].ClearF(0);
  EXPECT((polygons_of(MeshArrays(half)).first == Indices{0, 3, 6, 10, 14, 18}));

  // A fan whose every edge is faux: its middle is no corner of a polygon.
  CMeshO fan;
  Allocator::AddVertices(fan, 4);
  const Point3m corners[] = {{0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  for (int k = 0; k < 4; ++k) {
    fan.vert[k].P() = corners[k];
  }
  for (int k = 0; k < 3; ++k) {
    auto face = Allocator::AddFace(fan, 0, 1 + k, 1 + (k + 1) % 3);
    face->SetF(0);
    face->SetF(2);
  }
  EXPECT((polygons_of(MeshArrays(fan)).first == Indices{0, 3, 6, 9}));
}

void a_point_cloud_is_refused() {
  CMeshO points;
  Allocator::AddVertices(points, 3);
  try {
    const MeshArrays arrays(points);
    EXPECT(!"a mesh without faces was accepted");
  } catch (const MLException &error) {
    EXPECT(QString(error.what()).contains("no faces"));
  }
}

} // namespace

int main() {
  faux_edges_join_triangles();
  deleted_elements_do_not_count();
  faux_edges_that_make_no_polygon_are_ignored();
  a_point_cloud_is_refused();
}
