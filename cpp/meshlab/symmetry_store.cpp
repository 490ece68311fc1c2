// SPDX-License-Identifier: GPL-3.0-or-later
#include "symmetry_store.h"

#include <common/mlexception.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace {

using Allocator = vcg::tri::Allocator<CMeshO>;

const char *const RECORD = "intrinsic_symmetry";
const char *const SCALARS[] = {"sym_vertex", "sym_confidence", "sym_side", "sym_face"};
const char *const POINTS[] = {"sym_corners", "sym_barycentrics"};

// What the attributes belong to. Per mesh: it is gone where MeshLab copies a mesh, or reads it from a file.
struct Record {
  std::uint64_t connectivity_hash = 0;
  std::vector<isym_kind> kinds;
  OptionValues options;
};

std::optional<Record> record_of(CMeshO &mesh) {
  auto handle = Allocator::FindPerMeshAttribute<Record>(mesh, RECORD);
  return Allocator::IsValidHandle(mesh, handle) ? std::optional<Record>(handle()) : std::nullopt;
}

// A new attribute; one of the same name is gone, whatever it held.
template <typename Value> auto new_attribute(CMeshO &mesh, const char *name, std::size_t index) {
  const std::string full_name = attribute_name(name, index);
  Allocator::DeletePerVertexAttribute(mesh, full_name);
  return Allocator::AddPerVertexAttribute<Value>(mesh, full_name);
}

template <typename Value> auto kept_attribute(CMeshO &mesh, const char *name, std::size_t index) {
  const std::string full_name = attribute_name(name, index);
  auto handle = Allocator::FindPerVertexAttribute<Value>(mesh, full_name);
  if (!Allocator::IsValidHandle(mesh, handle)) {
    throw MLException(QString("The attribute %1 is gone: apply Compute Intrinsic Symmetry again.")
                          .arg(QString::fromStdString(full_name)));
  }
  return handle;
}

// -1 stands for ISYM_NONE.
Scalarm number_of(std::uint32_t index) { return index == ISYM_NONE ? Scalarm(-1) : Scalarm(index); }

// A whole number that was kept as a floating-point one, -1 or more.
std::int64_t whole(Scalarm value, const char *name) {
  if (!(value >= -1 && value < 4294967296.0) || value != std::floor(value)) {
    throw MLException(QString("The attribute %1 holds %2, which Compute Intrinsic Symmetry did not write: apply it "
                              "again.").arg(name).arg(double(value)));
  }
  return static_cast<std::int64_t>(value);
}

std::uint32_t index_of(Scalarm value, const char *name) {
  const std::int64_t number = whole(value, name);
  return number < 0 ? ISYM_NONE : static_cast<std::uint32_t>(number);
}

void keep(CMeshO &mesh, const MeshArrays &arrays, const isym::Result &result, std::size_t index) {
  auto partner = new_attribute<Scalarm>(mesh, SCALARS[0], index);
  auto confidence = new_attribute<Scalarm>(mesh, SCALARS[1], index);
  auto side = new_attribute<Scalarm>(mesh, SCALARS[2], index);
  auto face = new_attribute<Scalarm>(mesh, SCALARS[3], index);
  auto corners = new_attribute<Point3m>(mesh, POINTS[0], index);
  auto barycentrics = new_attribute<Point3m>(mesh, POINTS[1], index);
  const auto partners = result.partners(index);
  const auto confidences = result.confidences(index);
  const auto sides = result.sides(index);
  const auto points = result.surface_points(index);
  for (std::size_t vertex = 0; vertex < arrays.vertex_count(); ++vertex) {
    const std::size_t place = arrays.vertices()[vertex];
    const std::uint32_t polygon = points.faces[vertex];
    partner[place] = number_of(partners[vertex]);
    confidence[place] = confidences[vertex];
    side[place] = sides[vertex];
    face[place] = polygon == ISYM_NONE ? Scalarm(-1) : number_of(arrays.face_of_polygon()[polygon]);
    for (int k = 0; k < 3; ++k) {
      corners[place][k] = number_of(points.corners[3 * vertex + k]);
      barycentrics[place][k] = points.barycentrics[3 * vertex + k];
    }
  }
}

isym::Result restored(CMeshO &mesh, const MeshArrays &arrays, const isym::Mesh &validated, isym_kind kind,
                      std::size_t index) {
  auto partner = kept_attribute<Scalarm>(mesh, SCALARS[0], index);
  auto confidence = kept_attribute<Scalarm>(mesh, SCALARS[1], index);
  auto side = kept_attribute<Scalarm>(mesh, SCALARS[2], index);
  auto face = kept_attribute<Scalarm>(mesh, SCALARS[3], index);
  auto corners = kept_attribute<Point3m>(mesh, POINTS[0], index);
  auto barycentrics = kept_attribute<Point3m>(mesh, POINTS[1], index);
  std::vector<std::uint32_t> partners;
  std::vector<float> confidences;
  std::vector<std::int8_t> sides;
  isym::SurfacePoints points;
  for (const std::size_t place : arrays.vertices()) {
    partners.push_back(index_of(partner[place], SCALARS[0]));
    confidences.push_back(static_cast<float>(confidence[place]));
    sides.push_back(static_cast<std::int8_t>(std::min<std::int64_t>(whole(side[place], SCALARS[2]), 2)));
    const std::uint32_t kept_face = index_of(face[place], SCALARS[3]);
    const auto &polygons = arrays.polygon_of_face();
    points.faces.push_back(kept_face < polygons.size() ? polygons[kept_face] : ISYM_NONE);
    for (int k = 0; k < 3; ++k) {
      points.corners.push_back(index_of(corners[place][k], POINTS[0]));
      points.barycentrics.push_back(static_cast<float>(barycentrics[place][k]));
    }
  }
  return validated.restore(kind, partners, confidences, sides, points);
}

} // namespace

std::string attribute_name(const char *name, std::size_t index) {
  return index == 0 ? name : name + ("_" + std::to_string(index + 1));
}

isym::Result detect(const isym::Mesh &validated, const OptionValues &values, vcg::CallBackPos *callback) {
  isym::Options options;
  for (const auto &[name, value] : values) {
    options.set(name, value);
  }
  return beside_host(callback, [&](const isym::Progress &progress) { return validated.detect(options, progress); });
}

void forget_symmetries(CMeshO &mesh) {
  const std::optional<Record> record = record_of(mesh);
  for (std::size_t index = 0; record && index < record->kinds.size(); ++index) {
    for (const char *name : SCALARS) {
      Allocator::DeletePerVertexAttribute(mesh, attribute_name(name, index));
    }
    for (const char *name : POINTS) {
      Allocator::DeletePerVertexAttribute(mesh, attribute_name(name, index));
    }
  }
  Allocator::DeletePerMeshAttribute(mesh, std::string(RECORD));
}

void keep_symmetries(CMeshO &mesh, const MeshArrays &arrays, const isym::Mesh &validated, const isym::Result &result,
                     const OptionValues &options) {
  forget_symmetries(mesh);
  Record record{validated.connectivity_hash(), {}, options};
  for (std::size_t index = 0; index < result.symmetry_count(); ++index) {
    keep(mesh, arrays, result, index);
    record.kinds.push_back(result.summary(index).kind);
  }
  Allocator::GetPerMeshAttribute<Record>(mesh, RECORD)() = record;
}

FittingSymmetry fitting_symmetry(CMeshO &mesh, const MeshArrays &arrays, const isym::Mesh &validated,
                                 std::size_t index, vcg::CallBackPos *callback) {
  const std::optional<Record> record = record_of(mesh);
  if (record && record->connectivity_hash == validated.connectivity_hash() && index < record->kinds.size()) {
    return {restored(mesh, arrays, validated, record->kinds[index], index), 0, false};
  }
  OptionValues options = record ? record->options : OptionValues();
  if (index > 0 && (!record || index >= record->kinds.size())) {
    options.emplace_back("symmetries", double(index + 1));
  }
  isym::Result found = detect(validated, options, callback);
  const std::size_t count = found.symmetry_count();
  if (index >= count) {
    throw MLException(count == 0 ? QString("No symmetry was found on this mesh.")
                                 : QString("Symmetry %1 was asked for, %2 found.").arg(index + 1).arg(count));
  }
  keep_symmetries(mesh, arrays, validated, found, options);
  return {std::move(found), index, true};
}
