// Half-edge connectivity of polygons by OpenMesh, for the Rust side (src/lib.rs).
#pragma once

#include <OpenMesh/Core/Mesh/PolyConnectivity.hh>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "rust/cxx.h"

namespace intrinsym {

// A polygon mesh without geometry: PolyConnectivity is what PolyMesh_ArrayKernelT derives from,
// so no positions, normals or status flags are stored. Members throw; the bridge makes them Err.
class HalfEdgeMesh {
public:
  // Faces are offsets[f] .. offsets[f + 1] of `vertices`. Half-edges are numbered as OpenMesh's add_face numbers
  // them, but each face costs the same at any vertex. Throws std::invalid_argument for bad offsets or indices and
  // std::runtime_error where two faces run along an edge in one direction or a vertex has two fans of faces.
  HalfEdgeMesh(std::size_t vertex_count, rust::Slice<const std::uint32_t> offsets,
               rust::Slice<const std::uint32_t> vertices);

  std::size_t half_edge_count() const { return mesh_.n_halfedges(); }

  // Each slice has one entry per half-edge. A boundary half-edge has the face 2^32 - 1.
  void copy_half_edges(rust::Slice<std::uint32_t> to_vertex, rust::Slice<std::uint32_t> next,
                       rust::Slice<std::uint32_t> previous, rust::Slice<std::uint32_t> face) const;

  // One entry per vertex: an outgoing half-edge, the boundary one if there is one, otherwise that of the last face
  // around the vertex; 2^32 - 1 if no face refers to it.
  void copy_outgoing(rust::Slice<std::uint32_t> outgoing) const;

private:
  void add_face(const std::vector<OpenMesh::HalfedgeHandle>& sides, std::size_t face);
  // Joins the half-edges without a face, each to the one that leaves the vertex it points to.
  void close_holes();

  OpenMesh::PolyConnectivity mesh_;
};

std::unique_ptr<HalfEdgeMesh> build_half_edge_mesh(std::size_t vertex_count,
                                                   rust::Slice<const std::uint32_t> offsets,
                                                   rust::Slice<const std::uint32_t> vertices);

}  // namespace intrinsym
