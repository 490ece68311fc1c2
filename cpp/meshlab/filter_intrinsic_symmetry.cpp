// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_intrinsic_symmetry.h"

#include "actions.h"
#include "parameters.h"

#include <exception>
#include <new>

namespace {

const char *const CITATION =
    "<br><br>After:<br>"
    "<i>Yi-Ling Qiao, Lin Gao, Shu-Zhi Liu, Ligang Liu, Yu-Kun Lai, Xilin Chen</i><br>"
    "<b>\"Learning-based Real-time Detection of Intrinsic Reflectional Symmetry\"</b><br>";

const char *const USES_THE_MAP =
    "<br>It uses the map that <b>Compute Intrinsic Symmetry</b> left in the attributes of the layer. If there is "
    "none, or vertices or faces were added or removed since, the symmetry is found again; moving vertices keeps it.";

// One filter as the host shows it.
struct Description {
  const char *name;
  const char *python_name;
  const char *info;
  FilterPlugin::FilterClass filter_class;
  int post_condition;
};

FilterPlugin::FilterClass classes(int first, int second = 0, int third = 0) {
  return FilterPlugin::FilterClass(first | second | third);
}

const Description &description(MeshLabPlugin::ActionIDType filter) {
  using Plugin = FilterIntrinsicSymmetryPlugin;
  static const std::map<int, Description> descriptions = {
      {Plugin::FP_COMPUTE_SYMMETRY,
       {"Compute Intrinsic Symmetry", "compute_intrinsic_symmetry_per_vertex",
        "Pairs each vertex with its mirror image <b>along the surface</b>: left hand with right hand, whatever the "
        "pose, the position of the mesh and its connectivity. Where the connectivity is itself mirrored the map is "
        "exactly that bijection. Finding no symmetry is an answer too, and no error; a map that may be wrong is kept, and "
        "called doubtful.<br>"
        "The map is kept in custom attributes of the vertices: <b>sym_vertex</b> (the partner's index, -1 for none), "
        "<b>sym_confidence</b> (0 to 1), <b>sym_side</b> (-1, 0, 1), <b>sym_face</b>, <b>sym_corners</b> and "
        "<b>sym_barycentrics</b> (the exact mirror image, a point of the surface); a second symmetry's names end in "
        "_2, and so on.",
        classes(FilterPlugin::Measure, FilterPlugin::Quality, FilterPlugin::VertexColoring),
        // VERTNUMBER: there may be a layer more. It also spares users a preview that adds one at each change.
        MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTNUMBER}},
      {Plugin::FP_SELECT_VERTICES,
       {"Select Symmetric Vertices", "compute_selection_by_intrinsic_symmetry_per_vertex",
        "Selects the vertices that are the mirror image, along the surface, of the selected ones.",
        classes(FilterPlugin::Selection), MeshModel::MM_VERTFLAGSELECT}},
      {Plugin::FP_SELECT_FACES,
       {"Select Symmetric Faces", "compute_selection_by_intrinsic_symmetry_per_face",
        "Selects the faces that are the mirror image, along the surface, of the selected ones. Where the "
        "connectivity is mirrored each face goes to its exact counterpart; elsewhere a face is selected if all its "
        "vertices are mirror images of vertices of selected faces.",
        classes(FilterPlugin::Selection), MeshModel::MM_FACEFLAGSELECT}},
      {Plugin::FP_MIRROR_ATTRIBUTE,
       {"Mirror Vertex Attribute", "compute_attribute_by_intrinsic_symmetry_per_vertex",
        "Mirrors the quality, the colour or a custom attribute of the vertices across the intrinsic symmetry: the "
        "sides are swapped or averaged, or one side takes what the other has.",
        classes(FilterPlugin::Quality, FilterPlugin::VertexColoring),
        MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR}},
      {Plugin::FP_SYMMETRIZE,
       {"Symmetrize", "apply_coord_intrinsic_symmetrization",
        "Makes the shape symmetric in the pose it is in: one side takes the shape of the other, or both the mean of "
        "the two, in local frames. What is much smaller than the surface is carried whole; what is as large as the "
        "pose of a limb stays.",
        classes(FilterPlugin::Smoothing),
        MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL}},
      {Plugin::FP_FLAG_ASYMMETRY,
       {"Flag Asymmetric Regions", "compute_scalar_by_intrinsic_asymmetry_per_vertex",
        "Says where the two sides differ in shape, whatever the pose: dents, bumps, scanning errors, missing parts. "
        "The quality of a vertex becomes its distance from where the shape of its mirror image would put it, in the "
        "unit of the mesh; vertices above the threshold are selected.",
        classes(FilterPlugin::Quality, FilterPlugin::VertexColoring, FilterPlugin::Measure),
        MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTFLAGSELECT}},
  };
  return descriptions.at(filter);
}

Outputs apply(MeshLabPlugin::ActionIDType filter, const RichParameterList &parameters, MeshDocument &document,
              vcg::CallBackPos *callback) {
  using Plugin = FilterIntrinsicSymmetryPlugin;
  MeshModel &model = *document.mm();
  switch (filter) {
  case Plugin::FP_COMPUTE_SYMMETRY:
    return compute_symmetry(document, parameters, callback);
  case Plugin::FP_SELECT_VERTICES:
    return select_vertices(model, parameters, callback);
  case Plugin::FP_SELECT_FACES:
    return select_faces(model, parameters, callback);
  case Plugin::FP_MIRROR_ATTRIBUTE:
    return mirror_attribute(model, parameters, callback);
  case Plugin::FP_SYMMETRIZE:
    return symmetrize(model, parameters, callback);
  case Plugin::FP_FLAG_ASYMMETRY:
    return flag_asymmetry(model, parameters, callback);
  default:
    throw MLException("This plugin has no such filter.");
  }
}

} // namespace

FilterIntrinsicSymmetryPlugin::FilterIntrinsicSymmetryPlugin() {
  typeList = {FP_COMPUTE_SYMMETRY, FP_SELECT_VERTICES, FP_SELECT_FACES,
              FP_MIRROR_ATTRIBUTE, FP_SYMMETRIZE,      FP_FLAG_ASYMMETRY};
  for (const ActionIDType filter : types()) {
    actionList.push_back(new QAction(filterName(filter), this));
  }
}

QString FilterIntrinsicSymmetryPlugin::pluginName() const { return "FilterIntrinsicSymmetry"; }

QString FilterIntrinsicSymmetryPlugin::vendor() const { return "Intrinsym"; }

QString FilterIntrinsicSymmetryPlugin::filterName(ActionIDType filter) const { return description(filter).name; }

QString FilterIntrinsicSymmetryPlugin::pythonFilterName(ActionIDType filter) const {
  return description(filter).python_name;
}

QString FilterIntrinsicSymmetryPlugin::filterInfo(ActionIDType filter) const {
  const QString uses = filter == FP_COMPUTE_SYMMETRY ? "" : USES_THE_MAP;
  return description(filter).info + uses + CITATION;
}

FilterPlugin::FilterClass FilterIntrinsicSymmetryPlugin::getClass(const QAction *action) const {
  return description(ID(action)).filter_class;
}

FilterPlugin::FilterArity FilterIntrinsicSymmetryPlugin::filterArity(const QAction *) const { return SINGLE_MESH; }

int FilterIntrinsicSymmetryPlugin::getPreConditions(const QAction *) const { return MeshModel::MM_FACENUMBER; }

int FilterIntrinsicSymmetryPlugin::postCondition(const QAction *action) const {
  return description(ID(action)).post_condition;
}

RichParameterList FilterIntrinsicSymmetryPlugin::initParameterList(const QAction *action, const MeshModel &model) {
  switch (ID(action)) {
  case FP_COMPUTE_SYMMETRY:
    return compute_parameters();
  case FP_SELECT_VERTICES:
  case FP_SELECT_FACES:
    return selection_parameters();
  case FP_MIRROR_ATTRIBUTE:
    return mirror_parameters();
  case FP_SYMMETRIZE:
    return symmetrize_parameters();
  default:
    return asymmetry_parameters(model.cm.bbox.Diag());
  }
}

std::map<std::string, QVariant> FilterIntrinsicSymmetryPlugin::applyFilter(const QAction *action,
                                                                          const RichParameterList &parameters,
                                                                          MeshDocument &document, unsigned int &,
                                                                          vcg::CallBackPos *callback) {
  if (document.mm() == nullptr) {
    throw MLException("There is no layer.");
  }
  try {
    Outputs outputs = apply(ID(action), parameters, document, callback);
    if (outputs.count("symmetries_found") != 0) {
      const auto text = [&](const char *name) { return outputs[name].toString().toStdString(); };
      const int count = outputs["symmetries_found"].toInt();
      log("Symmetries found: %d, in %.2f s", count, outputs["seconds"].toDouble());
      if (count > 0) {
        log("%s", text("coverage").c_str());
      }
      if (!outputs["found"].toBool()) {
        log("%s: %s", count > 0 ? "Doubtful" : "No symmetry", text("evidence").c_str());
      }
      if (outputs["continuous_family"].toBool()) {
        log("The mesh has a continuous family of symmetries, as a sphere or a vase has: any one is as good");
      }
    }
    if (outputs.count("recomputed") != 0 && outputs["recomputed"].toBool()) {
      log("The mesh had no symmetry that fits it; it was found anew");
    }
    if (outputs.count("selected") != 0) {
      log("Selected: %d", outputs["selected"].toInt());
    }
    return outputs;
  } catch (const MLException &) {
    throw;
  } catch (const std::bad_alloc &) {
    throw MLException("There is not enough memory for this mesh.");
  } catch (const std::exception &error) {
    throw MLException(QString::fromUtf8(error.what()));
  }
}

MESHLAB_PLUGIN_NAME_EXPORTER(FilterIntrinsicSymmetryPlugin)
