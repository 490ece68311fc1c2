// SPDX-License-Identifier: GPL-3.0-or-later
// A MeshLab mesh as the arrays that the library takes, and the way back to its elements.
#ifndef INTRINSYM_MESHLAB_MESH_ARRAYS_H
#define INTRINSYM_MESHLAB_MESH_ARRAYS_H

#include <isym.hpp>

#include <common/ml_document/mesh_model.h>

#include <cstdint>
#include <vector>

// The vertices and faces that are not deleted, numbered in their order without gaps: as in a file that MeshLab
// writes. Triangles that share a faux edge are one polygon, with its corners as the file had them.
class MeshArrays {
public:
  // Throws MLException if there is no face.
  explicit MeshArrays(const CMeshO &mesh);

  std::size_t vertex_count() const { return vertices_.size(); }
  std::size_t polygon_count() const { return face_offsets_.size() - 1; }
  // Place in mesh.vert of each vertex.
  const std::vector<std::size_t> &vertices() const { return vertices_; }
  // Place in mesh.face of each face, and the polygon it belongs to.
  const std::vector<std::size_t> &faces() const { return faces_; }
  const std::vector<std::uint32_t> &polygon_of_face() const { return polygon_of_face_; }
  // The first face of each polygon.
  const std::vector<std::uint32_t> &face_of_polygon() const { return face_of_polygon_; }

  // x, y, z of each vertex.
  std::vector<double> positions() const { return {positions_.begin(), positions_.end()}; }
  // Throws isym::Error where the mesh cannot be used.
  isym::Mesh validated() const { return isym::Mesh::from_polygons(positions_, face_offsets_, corners_); }

private:
  void read_vertices(const CMeshO &mesh);
  void read_triangles(const CMeshO &mesh);
  void join_over_faux_edges(const CMeshO &mesh);
  void add_polygon(const std::vector<std::uint32_t> &corners, const std::vector<std::uint32_t> &faces);

  std::vector<std::size_t> vertices_, faces_;
  std::vector<std::uint32_t> polygon_of_face_, face_of_polygon_;
  std::vector<Scalarm> positions_;
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> face_offsets_{0}, corners_;
};

#endif
