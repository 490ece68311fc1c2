// SPDX-License-Identifier: GPL-3.0-or-later
// Compute Intrinsic Symmetry.
#include "actions.h"
#include "parameters.h"

#include <common/mlexception.h>

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace {

// Along the surface, in its unit. Shells that the line cannot reach get the largest distance of the others.
std::vector<double> line_distances(const isym::Result &result, const MeshArrays &arrays, std::size_t index) {
  if (result.curve(index).closed.empty()) {
    throw MLException("This symmetry has no mirror line to measure the distance from; choose another quality.");
  }
  std::vector<double> distances = result.curve_distances(arrays.positions(), index);
  double largest = 0;
  for (const double distance : distances) {
    largest = std::isfinite(distance) ? std::max(largest, distance) : largest;
  }
  for (double &distance : distances) {
    distance = std::min(distance, largest);
  }
  return distances;
}

std::vector<double> quality_of(const isym::Result &result, const MeshArrays &arrays, std::size_t index,
                               ShownQuality shown) {
  switch (shown) {
  case ShownQuality::confidence: {
    const auto values = result.confidences(index);
    return {values.begin(), values.end()};
  }
  case ShownQuality::side: {
    const auto values = result.sides(index);
    return {values.begin(), values.end()};
  }
  case ShownQuality::distance:
    return line_distances(result, arrays, index);
  default:
    return {};
  }
}

void write_quality(MeshModel &model, const MeshArrays &arrays, const std::vector<double> &quality) {
  model.updateDataMask(MeshModel::MM_VERTQUALITY);
  for (std::size_t vertex = 0; vertex < quality.size(); ++vertex) {
    model.cm.vert[arrays.vertices()[vertex]].Q() = Scalarm(quality[vertex]);
  }
}

void write_colours(MeshModel &model, const MeshArrays &arrays, const std::vector<std::uint8_t> &colours) {
  model.updateDataMask(MeshModel::MM_VERTCOLOR);
  for (std::size_t vertex = 0; vertex < arrays.vertex_count(); ++vertex) {
    const std::uint8_t *colour = &colours[3 * vertex];
    model.cm.vert[arrays.vertices()[vertex]].C() = vcg::Color4b(colour[0], colour[1], colour[2], 255);
  }
}

// A layer of edges where the mesh lies.
void add_mirror_line(MeshDocument &document, const MeshModel &model, const MeshArrays &arrays,
                     const isym::Curve &curve) {
  MeshModel &layer = *document.addNewMesh("", model.label() + " mirror line", false);
  const std::size_t points = curve.parameters.size();
  auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(layer.cm, points);
  for (std::size_t point = 0; point < points; ++point, ++vertex) {
    const Point3m &from = model.cm.vert[arrays.vertices()[curve.edges[2 * point]]].cP();
    const Point3m &to = model.cm.vert[arrays.vertices()[curve.edges[2 * point + 1]]].cP();
    vertex->P() = from + (to - from) * Scalarm(curve.parameters[point]);
  }
  for (std::size_t line = 0; line < curve.closed.size(); ++line) {
    const std::size_t first = curve.line_offsets[line], end = curve.line_offsets[line + 1];
    for (std::size_t point = first; point + 1 < end; ++point) {
      vcg::tri::Allocator<CMeshO>::AddEdge(layer.cm, point, point + 1);
    }
    if (curve.closed[line] != 0) {
      vcg::tri::Allocator<CMeshO>::AddEdge(layer.cm, end - 1, first);
    }
  }
  layer.cm.Tr = model.cm.Tr;
  layer.updateBoxAndNormals();
}

Outputs outputs_of(const isym::Result &result, std::size_t index) {
  Outputs outputs;
  const int count = static_cast<int>(result.symmetry_count());
  outputs["found"] = result.outcome() == ISYM_OUTCOME_FOUND;
  outputs["doubtful"] = result.outcome() == ISYM_OUTCOME_DOUBTFUL;
  outputs["symmetries_found"] = count;
  outputs["continuous_family"] = result.continuous_family();
  if (count > 0) {
    const isym_summary summary = result.summary(index);
    outputs["score"] = Scalarm(summary.score);
    outputs["mean_confidence"] = Scalarm(summary.mean_confidence);
    outputs["exact_share"] = Scalarm(summary.exact_share);
    outputs["is_reflection"] = summary.kind == ISYM_KIND_REFLECTION;
    outputs["paired_share"] = Scalarm(summary.paired_share);
    outputs["shells_paired"] = static_cast<int>(summary.shells_paired);
    outputs["shells_self_mirrored"] = static_cast<int>(summary.shells_self_mirrored);
    outputs["shells_alone"] = static_cast<int>(summary.shells_alone);
  }
  const QJsonObject report = QJsonDocument::fromJson(QByteArray::fromStdString(result.report())).object();
  const QJsonArray symmetries = report["symmetries"].toArray();
  outputs["evidence"] = report["report"].toObject()["evidence"].toString();
  outputs["coverage"] = symmetries.at(static_cast<int>(index)).toObject()["coverage"].toString();
  return outputs;
}

} // namespace

Outputs compute_symmetry(MeshDocument &document, const RichParameterList &parameters, vcg::CallBackPos *callback) {
  const auto start = std::chrono::steady_clock::now();
  MeshModel &model = *document.mm();
  const std::size_t index = chosen_symmetry(parameters);
  const OptionValues options = chosen_options(parameters);
  const MeshArrays arrays(model.cm);
  const isym::Mesh validated = arrays.validated();
  const isym::Result result = detect(validated, options, callback);
  const std::size_t count = result.symmetry_count();
  if (count > 0) {
    if (index >= count) {
      throw MLException(QString("Symmetry %1 was asked for, %2 found: ask for more symmetries, or for another one.")
                            .arg(index + 1).arg(count));
    }
    const auto quality = quality_of(result, arrays, index, ShownQuality(parameters.getEnum("quality")));
    const auto colours = result.pair_colours(index);
    keep_symmetries(model.cm, arrays, validated, result, options);
    if (!quality.empty()) {
      write_quality(model, arrays, quality);
    }
    if (parameters.getBool("colorize")) {
      write_colours(model, arrays, colours);
    }
    const isym::Curve curve = result.curve(index);
    if (parameters.getBool("mirror_line") && !curve.closed.empty()) {
      add_mirror_line(document, model, arrays, curve);
    }
  } else {
    forget_symmetries(model.cm);
  }
  Outputs outputs = outputs_of(result, index);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  outputs["seconds"] = Scalarm(elapsed.count());
  return outputs;
}
