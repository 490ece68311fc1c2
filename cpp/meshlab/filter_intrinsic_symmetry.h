// SPDX-License-Identifier: GPL-3.0-or-later
// MeshLab filters over the library's C interface: what they are called, ask for and say. What they do: actions.h.
#ifndef INTRINSYM_MESHLAB_FILTER_INTRINSIC_SYMMETRY_H
#define INTRINSYM_MESHLAB_FILTER_INTRINSIC_SYMMETRY_H

#include <common/plugins/interfaces/filter_plugin.h>

class FilterIntrinsicSymmetryPlugin : public QObject, public FilterPlugin {
  Q_OBJECT
  MESHLAB_PLUGIN_IID_EXPORTER(FILTER_PLUGIN_IID)
  Q_INTERFACES(FilterPlugin)

public:
  enum {
    FP_COMPUTE_SYMMETRY,
    FP_SELECT_VERTICES,
    FP_SELECT_FACES,
    FP_MIRROR_ATTRIBUTE,
    FP_SYMMETRIZE,
    FP_FLAG_ASYMMETRY,
  };

  FilterIntrinsicSymmetryPlugin();

  QString pluginName() const override;
  QString vendor() const override;
  QString filterName(ActionIDType filter) const override;
  QString pythonFilterName(ActionIDType filter) const override;
  QString filterInfo(ActionIDType filter) const override;
  FilterClass getClass(const QAction *action) const override;
  FilterArity filterArity(const QAction *action) const override;
  int getPreConditions(const QAction *action) const override;
  int postCondition(const QAction *action) const override;
  RichParameterList initParameterList(const QAction *action, const MeshModel &model) override;
  std::map<std::string, QVariant> applyFilter(const QAction *action, const RichParameterList &parameters,
                                              MeshDocument &document, unsigned int &post_condition_mask,
                                              vcg::CallBackPos *callback) override;
};

#endif
