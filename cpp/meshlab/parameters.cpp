// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameters.h"

#include <common/mlexception.h>

namespace {

// A list in the order of isym_merge.
const QStringList MERGES = {"Swap the sides", "Average of both sides", "Side +1 wins", "Side -1 wins"};

QString readable(const char *name) {
  QString text(name);
  text.replace('_', ' ');
  return text.left(1).toUpper() + text.mid(1);
}

bool is_switch(const isym_option_spec &spec) {
  return spec.choices == nullptr && spec.minimum == 0 && spec.maximum == 1;
}

// The options of the library, as its table describes them.
void add_options(RichParameterList &list) {
  for (const isym_option_spec &spec : isym::option_specs()) {
    const QString name(spec.name), label = readable(spec.name);
    const QString help = QString("%1 From %2 to %3.").arg(spec.help).arg(spec.minimum).arg(spec.maximum);
    const bool advanced = spec.is_expert == 1;
    const int value = static_cast<int>(spec.default_value);
    if (spec.choices != nullptr) {
      list.addParam(RichEnum(name, value, readable(spec.choices).split('|'), label, spec.help, advanced));
    } else if (is_switch(spec)) {
      list.addParam(RichBool(name, value != 0, label, spec.help, advanced));
    } else {
      list.addParam(RichInt(name, value, label, help, advanced));
    }
  }
}

void add_symmetry(RichParameterList &list, const char *help) {
  list.addParam(RichInt("symmetry", 1, "Symmetry",
                        QString("Which symmetry: 1 is the best; tables and boxes have more. ") + help));
}

void add_minimum_confidence(RichParameterList &list, const char *help) {
  list.addParam(RichDynamicFloat("minimum_confidence", 0, 0, 1, "Minimum confidence", help));
}

void add_mirroring(RichParameterList &list, isym_merge merge) {
  list.addParam(RichEnum("merge", merge, MERGES, "Merge",
                         "Which vertices take the value of their mirror image. Compute Intrinsic Symmetry shows the "
                         "two sides as quality; a half turn has no sides: swap or average."));
  add_minimum_confidence(list, "Vertices whose mirror image is less certain keep what they have.");
  list.addParam(RichBool("weight_by_confidence", false, "Weight by confidence",
                         "Each vertex changes by the share of its confidence instead of wholly."));
}

const char *const FOUND_AGAIN = "It is found again, as it was found the last time, if the mesh has none or its "
                                "connectivity has changed since.";

} // namespace

RichParameterList compute_parameters() {
  RichParameterList list;
  add_symmetry(list, "Quality, colour and mirror line show this one; the attributes hold all that were found.");
  list.addParam(RichEnum("quality", 0, {"Confidence", "Side", "Distance to the mirror line", "Leave as it is"},
                         "Quality", "What the quality of the vertices becomes."));
  list.addParam(RichBool("colorize", true, "Colour partners alike",
                         "Gives each vertex a colour that it shares with its mirror image; grey is not certain."));
  list.addParam(RichBool("mirror_line", false, "Mirror line as a new layer",
                         "Makes a layer of edges: the line between the two sides."));
  add_options(list);
  return list;
}

RichParameterList selection_parameters() {
  RichParameterList list;
  list.addParam(RichEnum("mode", 0, {"Replace the selection", "Add to the selection"}, "Mode",
                         "Whether what was selected stays selected."));
  add_minimum_confidence(list, "Where the mirror image is less certain nothing is selected.");
  add_symmetry(list, FOUND_AGAIN);
  return list;
}

RichParameterList mirror_parameters() {
  RichParameterList list;
  list.addParam(RichEnum("attribute", 0, {"Quality", "Color", "Custom attribute"}, "Attribute",
                         "What is mirrored."));
  list.addParam(RichString("custom_name", "", "Custom attribute",
                           "Name of the custom attribute, a number or a point per vertex."));
  list.addParam(RichBool("as_displacement", false, "Custom vectors are displacements",
                         "A custom attribute of three components is turned as the surface is: right for "
                         "displacements and normals, wrong for colours and coordinates."));
  add_mirroring(list, ISYM_MERGE_AVERAGE);
  add_symmetry(list, FOUND_AGAIN);
  return list;
}

RichParameterList symmetrize_parameters() {
  RichParameterList list;
  add_mirroring(list, ISYM_MERGE_AVERAGE);
  add_symmetry(list, FOUND_AGAIN);
  return list;
}

RichParameterList asymmetry_parameters(Scalarm diagonal) {
  RichParameterList list;
  list.addParam(RichPercentage("threshold", diagonal / 100, 0, diagonal, "Select above",
                               "Vertices farther than this from the shape of their mirror image are selected."));
  list.addParam(RichBool("colorize", true, "Colour by asymmetry", "Shows the quality as colour."));
  add_symmetry(list, FOUND_AGAIN);
  return list;
}

OptionValues chosen_options(const RichParameterList &parameters) {
  OptionValues values;
  for (const isym_option_spec &spec : isym::option_specs()) {
    const double value = spec.choices != nullptr ? double(parameters.getEnum(spec.name))
                         : is_switch(spec)       ? double(parameters.getBool(spec.name))
                                                 : double(parameters.getInt(spec.name));
    if (value != spec.default_value) {
      values.emplace_back(spec.name, value);
    }
  }
  return values;
}

std::size_t chosen_symmetry(const RichParameterList &parameters) {
  const int number = parameters.getInt("symmetry");
  if (number < 1) {
    throw MLException(QString("Symmetry %1 was asked for; they are counted from 1.").arg(number));
  }
  return static_cast<std::size_t>(number - 1);
}

isym::Mirroring chosen_mirroring(const RichParameterList &parameters) {
  isym::Mirroring mirroring;
  mirroring.merge = static_cast<isym_merge>(parameters.getEnum("merge"));
  mirroring.minimum_confidence = static_cast<float>(parameters.getDynamicFloat("minimum_confidence"));
  mirroring.weight_by_confidence = parameters.getBool("weight_by_confidence");
  return mirroring;
}
