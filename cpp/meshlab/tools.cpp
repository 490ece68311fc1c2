// SPDX-License-Identifier: GPL-3.0-or-later
// The filters that use a symmetry: select, mirror, symmetrize, flag.
#include "actions.h"
#include "parameters.h"

#include <common/mlexception.h>
#include <vcg/complex/algorithms/update/color.h>

#include <algorithm>
#include <cmath>

namespace {

using Allocator = vcg::tri::Allocator<CMeshO>;

// The mesh, and the symmetry that fits it.
struct Subject {
  CMeshO &mesh;
  MeshArrays arrays;
  isym::Mesh validated;
  FittingSymmetry found;

  Subject(CMeshO &mesh, const RichParameterList &parameters, vcg::CallBackPos *callback)
      : mesh(mesh), arrays(mesh), validated(arrays.validated()),
        found(fitting_symmetry(mesh, arrays, validated, chosen_symmetry(parameters), callback)) {}

  CVertexO &vertex(std::size_t index) { return mesh.vert[arrays.vertices()[index]]; }
  std::vector<double> moved(const isym::Mirroring &mirroring, vcg::CallBackPos *callback) const {
    return beside_host(callback, [&](const isym::Progress &progress) {
      return found.result.symmetrize_positions(arrays.positions(), mirroring, progress, found.index);
    });
  }
};

bool adds(const RichParameterList &parameters) { return parameters.getEnum("mode") == 1; }

float minimum_confidence(const RichParameterList &parameters) {
  return static_cast<float>(parameters.getDynamicFloat("minimum_confidence"));
}

Outputs selection_outputs(int selected, const FittingSymmetry &found) {
  return {{"selected", selected}, {"recomputed", found.recomputed}};
}

// Distance between the same vertex in two arrays of x, y, z.
std::vector<double> distances(const std::vector<double> &from, const std::vector<double> &to) {
  std::vector<double> found(from.size() / 3);
  for (std::size_t vertex = 0; vertex < found.size(); ++vertex) {
    const std::size_t x = 3 * vertex;
    found[vertex] = std::hypot(to[x] - from[x], to[x + 1] - from[x + 1], to[x + 2] - from[x + 2]);
  }
  return found;
}

Outputs distance_outputs(const std::vector<double> &distances, const char *name, const FittingSymmetry &found) {
  double sum = 0, largest = 0;
  for (const double distance : distances) {
    sum += distance;
    largest = std::max(largest, distance);
  }
  const double mean = distances.empty() ? 0 : sum / static_cast<double>(distances.size());
  return {{std::string("mean_") + name, Scalarm(mean)},
          {std::string("max_") + name, Scalarm(largest)},
          {"recomputed", found.recomputed}};
}

// Values of a number per vertex, read and written by one function that gives a reference to it.
template <typename Reference>
void mirror_numbers(Subject &subject, const isym::Mirroring &mirroring, Reference reference) {
  std::vector<double> values;
  for (std::size_t vertex = 0; vertex < subject.arrays.vertex_count(); ++vertex) {
    values.push_back(reference(vertex));
  }
  values = subject.found.result.mirror_values(values, 1, mirroring, subject.found.index);
  for (std::size_t vertex = 0; vertex < values.size(); ++vertex) {
    reference(vertex) = Scalarm(values[vertex]);
  }
}

void mirror_colours(Subject &subject, const isym::Mirroring &mirroring) {
  std::vector<double> values;
  for (std::size_t vertex = 0; vertex < subject.arrays.vertex_count(); ++vertex) {
    for (int k = 0; k < 4; ++k) {
      values.push_back(subject.vertex(vertex).cC()[k]);
    }
  }
  values = subject.found.result.mirror_values(values, 4, mirroring, subject.found.index);
  for (std::size_t index = 0; index < values.size(); ++index) {
    const double rounded = std::round(std::clamp(values[index], 0.0, 255.0));
    subject.vertex(index / 4).C()[static_cast<int>(index % 4)] = static_cast<unsigned char>(rounded);
  }
}

template <typename Handle>
void mirror_points(Subject &subject, const isym::Mirroring &mirroring, bool as_displacement, Handle handle) {
  std::vector<double> values;
  for (const std::size_t place : subject.arrays.vertices()) {
    for (int k = 0; k < 3; ++k) {
      values.push_back(handle[place][k]);
    }
  }
  const isym::Result &result = subject.found.result;
  values = as_displacement
               ? result.carry_displacement(subject.arrays.positions(), values, mirroring, subject.found.index)
               : result.mirror_values(values, 3, mirroring, subject.found.index);
  for (std::size_t index = 0; index < values.size(); ++index) {
    handle[subject.arrays.vertices()[index / 3]][static_cast<int>(index % 3)] = Scalarm(values[index]);
  }
}

void mirror_custom(Subject &subject, const isym::Mirroring &mirroring, const RichParameterList &parameters) {
  const std::string name = parameters.getString("custom_name").trimmed().toStdString();
  if (name.empty()) {
    throw MLException("Write the name of the custom attribute that is to be mirrored.");
  }
  auto numbers = Allocator::FindPerVertexAttribute<Scalarm>(subject.mesh, name);
  auto points = Allocator::FindPerVertexAttribute<Point3m>(subject.mesh, name);
  if (Allocator::IsValidHandle(subject.mesh, numbers)) {
    mirror_numbers(subject, mirroring,
                   [&](std::size_t vertex) -> Scalarm & { return numbers[subject.arrays.vertices()[vertex]]; });
  } else if (Allocator::IsValidHandle(subject.mesh, points)) {
    mirror_points(subject, mirroring, parameters.getBool("as_displacement"), points);
  } else {
    throw MLException(QString("The vertices have no custom attribute %1 that is a number or a point.")
                          .arg(QString::fromStdString(name)));
  }
}

} // namespace

Outputs select_vertices(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback) {
  Subject subject(model.cm, parameters, callback);
  std::vector<std::uint8_t> selected(subject.arrays.vertex_count());
  for (std::size_t vertex = 0; vertex < selected.size(); ++vertex) {
    selected[vertex] = subject.vertex(vertex).IsS();
  }
  const auto mirrored =
      subject.found.result.mirror_selection(selected, minimum_confidence(parameters), subject.found.index);
  int count = 0;
  for (std::size_t vertex = 0; vertex < selected.size(); ++vertex) {
    const bool wanted = mirrored[vertex] != 0 || (adds(parameters) && selected[vertex] != 0);
    wanted ? subject.vertex(vertex).SetS() : subject.vertex(vertex).ClearS();
    count += wanted;
  }
  return selection_outputs(count, subject.found);
}

Outputs select_faces(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback) {
  Subject subject(model.cm, parameters, callback);
  const auto &polygons = subject.arrays.polygon_of_face();
  std::vector<std::uint8_t> selected(subject.arrays.polygon_count());
  for (std::size_t face = 0; face < polygons.size(); ++face) {
    selected[polygons[face]] |= subject.mesh.face[subject.arrays.faces()[face]].IsS();
  }
  const auto mirrored =
      subject.found.result.mirror_face_selection(selected, minimum_confidence(parameters), subject.found.index);
  int count = 0;
  for (std::size_t face = 0; face < polygons.size(); ++face) {
    CFaceO &element = subject.mesh.face[subject.arrays.faces()[face]];
    const bool wanted = mirrored[polygons[face]] != 0 || (adds(parameters) && element.IsS());
    wanted ? element.SetS() : element.ClearS();
    count += wanted;
  }
  return selection_outputs(count, subject.found);
}

Outputs mirror_attribute(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback) {
  const auto attribute = MirroredAttribute(parameters.getEnum("attribute"));
  const isym::Mirroring mirroring = chosen_mirroring(parameters);
  if (attribute == MirroredAttribute::quality && !model.hasDataMask(MeshModel::MM_VERTQUALITY)) {
    throw MLException("The vertices have no quality to mirror.");
  }
  if (attribute == MirroredAttribute::color && !model.hasDataMask(MeshModel::MM_VERTCOLOR)) {
    throw MLException("The vertices have no colour to mirror.");
  }
  Subject subject(model.cm, parameters, callback);
  switch (attribute) {
  case MirroredAttribute::quality:
    mirror_numbers(subject, mirroring, [&](std::size_t vertex) -> Scalarm & { return subject.vertex(vertex).Q(); });
    break;
  case MirroredAttribute::color:
    mirror_colours(subject, mirroring);
    break;
  default:
    mirror_custom(subject, mirroring, parameters);
  }
  return {{"recomputed", subject.found.recomputed}};
}

Outputs symmetrize(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback) {
  Subject subject(model.cm, parameters, callback);
  const std::vector<double> moved = subject.moved(chosen_mirroring(parameters), callback);
  const Outputs outputs =
      distance_outputs(distances(subject.arrays.positions(), moved), "displacement", subject.found);
  for (std::size_t vertex = 0; vertex < subject.arrays.vertex_count(); ++vertex) {
    const double *position = &moved[3 * vertex];
    subject.vertex(vertex).P() = Point3m(Scalarm(position[0]), Scalarm(position[1]), Scalarm(position[2]));
  }
  model.updateBoxAndNormals();
  return outputs;
}

Outputs flag_asymmetry(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback) {
  Subject subject(model.cm, parameters, callback);
  const double threshold = parameters.getAbsPerc("threshold");
  const std::vector<double> moved = subject.moved(isym::Mirroring(), callback);
  const std::vector<double> asymmetry = distances(subject.arrays.positions(), moved);
  int count = 0;
  model.updateDataMask(MeshModel::MM_VERTQUALITY);
  for (std::size_t vertex = 0; vertex < asymmetry.size(); ++vertex) {
    const bool flagged = asymmetry[vertex] > threshold;
    flagged ? subject.vertex(vertex).SetS() : subject.vertex(vertex).ClearS();
    subject.vertex(vertex).Q() = Scalarm(asymmetry[vertex]);
    count += flagged;
  }
  if (parameters.getBool("colorize")) {
    model.updateDataMask(MeshModel::MM_VERTCOLOR);
    vcg::tri::UpdateColor<CMeshO>::PerVertexQualityRamp(model.cm);
  }
  Outputs outputs = distance_outputs(asymmetry, "asymmetry", subject.found);
  outputs["selected"] = count;
  return outputs;
}
