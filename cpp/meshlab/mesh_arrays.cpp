// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_arrays.h"

#include <common/mlexception.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_map>

namespace {

using Corners = std::vector<std::uint32_t>;

// An edge of a triangle, in the triangle's direction.
struct Edge {
  std::uint32_t from, to, face;
};

std::uint32_t root_of(Corners &parent, std::uint32_t face) {
  while (parent[face] != face) {
    parent[face] = parent[parent[face]];
    face = parent[face];
  }
  return face;
}

// Joins the two faces of each edge that both of them call faux.
void join_faces(std::vector<Edge> faux, Corners &parent) {
  const auto key = [](const Edge &edge) { return std::minmax(edge.from, edge.to); };
  std::stable_sort(faux.begin(), faux.end(), [&](const Edge &a, const Edge &b) { return key(a) < key(b); });
  for (std::size_t first = 0; first < faux.size();) {
    std::size_t end = first + 1;
    while (end < faux.size() && key(faux[end]) == key(faux[first])) {
      ++end;
    }
    if (end - first == 2 && faux[first].from == faux[first + 1].to) {
      const auto one = root_of(parent, faux[first].face), other = root_of(parent, faux[first + 1].face);
      parent[std::max(one, other)] = std::min(one, other);
    }
    first = end;
  }
}

// The corners around triangles that were joined, from the first corner of the first one on; empty unless they
// are a disc with all its vertices on the rim.
Corners rim(const std::vector<std::uint32_t> &triangles, const Corners &faces) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const auto face : faces) {
    for (int k = 0; k < 3; ++k) {
      edges.push_back({triangles[3 * face + k], triangles[3 * face + (k + 1) % 3]});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::unordered_map<std::uint32_t, std::uint32_t> next;
  for (const auto &[from, to] : edges) {
    const bool inside = std::binary_search(edges.begin(), edges.end(), std::array{to, from});
    if (!inside && !next.emplace(from, to).second) {
      return {};
    }
  }
  const std::uint32_t start = triangles[3 * faces.front()];
  Corners around;
  for (auto at = next.find(start); at != next.end() && around.size() < next.size(); at = next.find(at->second)) {
    around.push_back(at->first);
    if (at->second == start) {
      break;
    }
  }
  return around.size() == faces.size() + 2 && around.size() == next.size() ? around : Corners();
}

} // namespace

MeshArrays::MeshArrays(const CMeshO &mesh) {
  read_vertices(mesh);
  read_triangles(mesh);
  if (faces_.empty()) {
    throw MLException("The mesh has no faces: a symmetry along the surface needs a surface. Reconstruct one from "
                      "the points first (Filters > Remeshing, Simplification and Reconstruction).");
  }
  join_over_faux_edges(mesh);
}

void MeshArrays::read_vertices(const CMeshO &mesh) {
  for (std::size_t place = 0; place < mesh.vert.size(); ++place) {
    if (!mesh.vert[place].IsD()) {
      vertices_.push_back(place);
      for (int axis = 0; axis < 3; ++axis) {
        positions_.push_back(mesh.vert[place].cP()[axis]);
      }
    }
  }
}

void MeshArrays::read_triangles(const CMeshO &mesh) {
  std::vector<std::uint32_t> number(mesh.vert.size(), ISYM_NONE);
  for (std::size_t vertex = 0; vertex < vertices_.size(); ++vertex) {
    number[vertices_[vertex]] = static_cast<std::uint32_t>(vertex);
  }
  for (std::size_t place = 0; place < mesh.face.size(); ++place) {
    if (!mesh.face[place].IsD()) {
      faces_.push_back(place);
      for (int k = 0; k < 3; ++k) {
        triangles_.push_back(number[vcg::tri::Index(mesh, mesh.face[place].cV(k))]);
      }
    }
  }
}

void MeshArrays::join_over_faux_edges(const CMeshO &mesh) {
  std::vector<Edge> faux;
  Corners parent(faces_.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (std::uint32_t face = 0; face < faces_.size(); ++face) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.face[faces_[face]].IsF(k)) {
        faux.push_back({triangles_[3 * face + k], triangles_[3 * face + (k + 1) % 3], face});
      }
    }
  }
  join_faces(std::move(faux), parent);

  std::vector<Corners> members(faces_.size());
  for (std::uint32_t face = 0; face < faces_.size(); ++face) {
    members[root_of(parent, face)].push_back(face);
  }
  polygon_of_face_.resize(faces_.size());
  for (const Corners &joined : members) {
    const Corners around = joined.size() > 1 ? rim(triangles_, joined) : Corners();
    if (!around.empty()) {
      add_polygon(around, joined);
    } else {
      for (const auto face : joined) {
        add_polygon({triangles_.begin() + 3 * face, triangles_.begin() + 3 * face + 3}, {face});
      }
    }
  }
}

void MeshArrays::add_polygon(const Corners &corners, const Corners &faces) {
  for (const auto face : faces) {
    polygon_of_face_[face] = static_cast<std::uint32_t>(polygon_count());
  }
  face_of_polygon_.push_back(faces.front());
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  face_offsets_.push_back(static_cast<std::uint32_t>(corners_.size()));
}
