#include "openmesh-sys/cpp/half_edges.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace intrinsym {
namespace {

using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;
using Indices = rust::Slice<const std::uint32_t>;
using Output = rust::Slice<std::uint32_t>;

void require_face(Indices offsets, Indices vertices, std::size_t face, std::size_t vertex_count) {
  if (offsets[face] > offsets[face + 1] || offsets[face + 1] > vertices.size()) {
    throw std::invalid_argument("offsets of face " + std::to_string(face) + " are out of order");
  }
  for (std::size_t corner = offsets[face]; corner < offsets[face + 1]; ++corner) {
    if (vertices[corner] >= vertex_count) {
      throw std::invalid_argument("face " + std::to_string(face) + " refers to a missing vertex");
    }
  }
  if (offsets[face + 1] - offsets[face] < 3) {
    throw std::invalid_argument("face " + std::to_string(face) + " has fewer than three corners");
  }
}

// The edges of a mesh by their ends. OpenMesh's own search walks round a vertex: the square of the degree at a hub.
class EdgeIndex {
public:
  EdgeIndex(OpenMesh::PolyConnectivity& mesh, std::size_t most_edges) : mesh_(mesh) {
    std::size_t size = 16;
    while (size < 2 * most_edges) {
      size *= 2;
    }
    edges_.assign(size, -1);
  }

  // The half-edge between two vertices, which may be new.
  HalfedgeHandle between(VertexHandle from, VertexHandle to) {
    for (std::size_t place = first_place(from, to);; place = (place + 1) & (edges_.size() - 1)) {
      if (edges_[place] < 0) {
        const HalfedgeHandle made = mesh_.new_edge(from, to);
        edges_[place] = made.idx() / 2;
        return made;
      }
      const HalfedgeHandle known(2 * edges_[place]);
      const VertexHandle tail = mesh_.from_vertex_handle(known), head = mesh_.to_vertex_handle(known);
      if (tail == from && head == to) {
        return known;
      }
      if (tail == to && head == from) {
        return mesh_.opposite_halfedge_handle(known);
      }
    }
  }

private:
  std::size_t first_place(VertexHandle a, VertexHandle b) const {
    const auto low = static_cast<std::uint64_t>(std::min(a.idx(), b.idx()));
    const auto high = static_cast<std::uint64_t>(std::max(a.idx(), b.idx()));
    const std::uint64_t mixed = (low << 32 | high) * 0x9E3779B97F4A7C15u;
    return static_cast<std::size_t>(mixed >> 20) & (edges_.size() - 1);
  }

  OpenMesh::PolyConnectivity& mesh_;
  std::vector<int> edges_;
};

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
  EdgeIndex edges(mesh_, vertices.size());
  std::vector<HalfedgeHandle> sides;
  for (std::size_t face = 0; face < face_count; ++face) {
    require_face(offsets, vertices, face, vertex_count);
    const std::size_t begin = offsets[face], count = offsets[face + 1] - begin;
    sides.clear();
    for (std::size_t corner = 0; corner < count; ++corner) {
      const VertexHandle from(static_cast<int>(vertices[begin + corner]));
      sides.push_back(edges.between(from, VertexHandle(static_cast<int>(vertices[begin + (corner + 1) % count]))));
    }
    add_face(sides, face);
  }
  close_holes();
}

void HalfEdgeMesh::add_face(const std::vector<HalfedgeHandle>& sides, std::size_t face) {
  const OpenMesh::FaceHandle handle = mesh_.new_face();
  mesh_.set_halfedge_handle(handle, sides.back());
  for (std::size_t side = 0; side < sides.size(); ++side) {
    if (!mesh_.is_boundary(sides[side])) {
      throw std::runtime_error("face " + std::to_string(face) + " is not manifold: another one has its edge");
    }
    mesh_.set_face_handle(sides[side], handle);
    mesh_.set_next_halfedge_handle(sides[side], sides[(side + 1) % sides.size()]);
    mesh_.set_halfedge_handle(mesh_.from_vertex_handle(sides[side]), sides[side]);
  }
}

void HalfEdgeMesh::close_holes() {
  std::vector<HalfedgeHandle> leaving(mesh_.n_vertices());
  const auto each_boundary = [&](const auto& visit) {
    for (std::size_t index = 0; index < mesh_.n_halfedges(); ++index) {
      const HalfedgeHandle half_edge(static_cast<int>(index));
      if (mesh_.is_boundary(half_edge)) {
        visit(half_edge);
      }
    }
  };
  each_boundary([&](HalfedgeHandle half_edge) {
    const VertexHandle from = mesh_.from_vertex_handle(half_edge);
    HalfedgeHandle& known = leaving[static_cast<std::size_t>(from.idx())];
    if (known.is_valid()) {
      throw std::runtime_error("vertex " + std::to_string(from.idx()) + " is not manifold: it has two fans of faces");
    }
    known = half_edge;
    mesh_.set_halfedge_handle(from, half_edge);
  });
  each_boundary([&](HalfedgeHandle half_edge) {
    const VertexHandle to = mesh_.to_vertex_handle(half_edge);
    mesh_.set_next_halfedge_handle(half_edge, leaving[static_cast<std::size_t>(to.idx())]);
  });
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
