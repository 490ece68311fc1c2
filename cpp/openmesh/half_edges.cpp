#include "intrinsym/cpp/openmesh/half_edges.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace intrinsym {
namespace {

using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;
using Indices = rust::Slice<const std::uint32_t>;
using Output = rust::Slice<std::uint32_t>;

std::vector<VertexHandle> face_handles(Indices offsets, Indices vertices, std::size_t face,
                                       std::size_t vertex_count) {
  if (offsets[face] > offsets[face + 1] || offsets[face + 1] > vertices.size()) {
    throw std::invalid_argument("offsets of face " + std::to_string(face) + " are out of order");
  }
  std::vector<VertexHandle> handles;
  handles.reserve(offsets[face + 1] - offsets[face]);
  for (std::size_t corner = offsets[face]; corner < offsets[face + 1]; ++corner) {
    if (vertices[corner] >= vertex_count) {
      throw std::invalid_argument("face " + std::to_string(face) + " refers to a missing vertex");
    }
    handles.emplace_back(static_cast<int>(vertices[corner]));
  }
  if (handles.size() < 3) {
    throw std::invalid_argument("face " + std::to_string(face) + " has fewer than three corners");
  }
  return handles;
}

void require_size(Output slice, std::size_t expected) {
  if (slice.size() != expected) {
    throw std::invalid_argument("the output has " + std::to_string(slice.size()) + " entries instead of " +
                                std::to_string(expected));
  }
}

// OpenMesh's invalid handle is -1, which becomes 2^32 - 1 here.
template <typename Handle>
std::uint32_t index_of(Handle handle) {
  return static_cast<std::uint32_t>(handle.idx());
}

}  // namespace

HalfEdgeMesh::HalfEdgeMesh(std::size_t vertex_count, Indices offsets, Indices vertices) {
  if (offsets.empty()) {
    throw std::invalid_argument("the face offsets are empty");
  }
  const std::size_t face_count = offsets.size() - 1;
  mesh_.reserve(vertex_count, vertex_count + face_count, face_count);
  mesh_.resize(vertex_count, 0, 0);
  for (std::size_t face = 0; face < face_count; ++face) {
    const auto handles = face_handles(offsets, vertices, face, vertex_count);
    if (!mesh_.add_face(handles.data(), handles.size()).is_valid()) {
      throw std::runtime_error("OpenMesh refused face " + std::to_string(face) + " as non-manifold");
    }
  }
}

void HalfEdgeMesh::copy_half_edges(Output to_vertex, Output next, Output previous, Output face) const {
  const std::size_t count = mesh_.n_halfedges();
  for (const Output& slice : {to_vertex, next, previous, face}) {
    require_size(slice, count);
  }
  for (std::size_t index = 0; index < count; ++index) {
    const HalfedgeHandle half_edge(static_cast<int>(index));
    to_vertex[index] = index_of(mesh_.to_vertex_handle(half_edge));
    next[index] = index_of(mesh_.next_halfedge_handle(half_edge));
    previous[index] = index_of(mesh_.prev_halfedge_handle(half_edge));
    face[index] = index_of(mesh_.face_handle(half_edge));
  }
}

void HalfEdgeMesh::copy_outgoing(Output outgoing) const {
  require_size(outgoing, mesh_.n_vertices());
  for (std::size_t index = 0; index < outgoing.size(); ++index) {
    outgoing[index] = index_of(mesh_.halfedge_handle(VertexHandle(static_cast<int>(index))));
  }
}

std::unique_ptr<HalfEdgeMesh> build_half_edge_mesh(std::size_t vertex_count, Indices offsets, Indices vertices) {
  return std::make_unique<HalfEdgeMesh>(vertex_count, offsets, vertices);
}

}  // namespace intrinsym
