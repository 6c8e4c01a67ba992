#pragma once

#include <array>
#include <vector>

#include "core/map/marker_map.h"
#include "mapbuilder/growth/joint_build.h"
#include "mapbuilder/growth/localized_frame_set.h"

namespace waymark {

/// What the finished map leaves of one observation.
struct ObservationResidual {
  std::size_t observation = 0;                ///< index in the table
  bool accepted = false;                      ///< by the gate
  std::array<Eigen::Vector2d, 4> corners_px;  ///< observed less predicted
};

/// One sub-map beside what the map file does not hold.
struct BuiltSubMap {
  SubMap map;
  std::vector<LocalizedFrameSet> trajectory;  ///< by rising table index; unambiguous ones only
  std::vector<int>
      ambiguous;  ///< frame sets whose runner-up explains their data too; in no trajectory
  /// Of all observations that have a prediction: of mapped markers in localized frame sets.
  std::vector<ObservationResidual> residuals;
  double model_sigma_px = 0;     ///< estimated, per axis
  std::size_t observations = 0;  ///< of mapped markers in localized frame sets
  std::size_t rejected = 0;      ///< of these, by the gate
  std::vector<SurveyResidual> survey;
  /// See scale_bound.h: per camera of the table's rigs, where no measured length tells the scale.
  std::vector<double> scale_per_edge_px;
  bool settled = false;            ///< converged, with gate, flips and noise at rest
  bool covariances_known = false;  ///< false: the map holds them as unknown, as of a marker alone
};

/// Statistics, covariances and trajectory of a finished build's markers that stand in one world:
/// the facility's where the part's own survey points fix it there, else that of its seed's rig
/// (paper §III-F.1), of each part its own.
[[nodiscard]] BuiltSubMap describe(const JointBuild& build, const Component& part);

/// Whether survey points on the part's markers fix all six freedoms of its world, which the build
/// has laid into the facility's.
[[nodiscard]] bool stands_in_facility(const JointBuild& build, const Component& part);

}  // namespace waymark
