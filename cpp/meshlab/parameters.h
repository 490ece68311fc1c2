// SPDX-License-Identifier: GPL-3.0-or-later
// The parameters of the filters: how they are shown, and what was chosen.
#ifndef INTRINSYM_MESHLAB_PARAMETERS_H
#define INTRINSYM_MESHLAB_PARAMETERS_H

#include "symmetry_store.h"

#include <common/parameters/rich_parameter_list.h>

// Quality that Compute Intrinsic Symmetry writes, in the order of its list.
enum class ShownQuality { confidence, side, distance, unchanged };
// What Mirror Vertex Attribute mirrors, in the order of its list.
enum class MirroredAttribute { quality, color, custom };

RichParameterList compute_parameters();
RichParameterList selection_parameters();
RichParameterList mirror_parameters();
RichParameterList symmetrize_parameters();
// `diagonal`: of the mesh's bounding box.
RichParameterList asymmetry_parameters(Scalarm diagonal);

// The library's options among the parameters, for those that differ from their defaults.
OptionValues chosen_options(const RichParameterList &parameters);
// From 0. Throws MLException for a number below 1.
std::size_t chosen_symmetry(const RichParameterList &parameters);
isym::Mirroring chosen_mirroring(const RichParameterList &parameters);

#endif
