// SPDX-License-Identifier: GPL-3.0-or-later
// What each filter does. All throw MLException or isym::Error, and change nothing then.
#ifndef INTRINSYM_MESHLAB_ACTIONS_H
#define INTRINSYM_MESHLAB_ACTIONS_H

#include <common/ml_document/mesh_document.h>
#include <common/parameters/rich_parameter_list.h>

#include <QVariant>

#include <map>
#include <string>

// What a filter answers to scripts: numbers and truth values by name.
using Outputs = std::map<std::string, QVariant>;

Outputs compute_symmetry(MeshDocument &document, const RichParameterList &parameters, vcg::CallBackPos *callback);
Outputs select_vertices(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback);
Outputs select_faces(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback);
Outputs mirror_attribute(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback);
Outputs symmetrize(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback);
Outputs flag_asymmetry(MeshModel &model, const RichParameterList &parameters, vcg::CallBackPos *callback);

#endif
