#pragma once

#include <vector>

#include "core/map/marker_map.h"
#include "mapbuilder/build/build_options.h"
#include "mapbuilder/build/submap_residuals.h"
#include "mapbuilder/bundle/consider_covariance.h"
#include "mapbuilder/bundle/survey_factors.h"
#include "mapbuilder/calibration/calibration.h"
#include "mapbuilder/growth/localized_frame_set.h"

namespace waymark {

/// One sub-map beside what the map file does not hold.
struct BuiltSubMap {
  SubMap map;
  std::vector<LocalizedFrameSet> trajectory;  ///< by rising index; unambiguous ones only
  /// Frame sets whose runner-up explains their data too; in no trajectory.
  std::vector<FrameSetIndex> ambiguous;
  /// Of all observations that have a prediction: of mapped markers in localized frame sets.
  std::vector<ObservationResidual> residuals;
  double model_sigma_px = 0;     ///< estimated, per axis
  std::size_t observations = 0;  ///< of mapped markers in localized frame sets
  std::size_t rejected = 0;      ///< of these, by the gate
  std::vector<SurveyResidual> survey;
  std::optional<ScaleUncertainty> scale;  ///< nullopt where covariances are not known
  /// Noise of corners once what calibration and sizes may be wrong by is told from it, as a share
  /// of model_sigma_px and the detector's.
  double noise_share = 1;
  double dropped_mean = 0;  ///< of markers' variance, by modes that the map has no place for
  double dropped_worst = 0;
  bool converged = false;          ///< with gate, flips and noise at rest
  bool covariances_known = false;  ///< false: the map holds them as unknown, as of a marker alone
};

/// Statistics, covariances and trajectory of a finished estimate's markers that stand in one world,
/// given with the frame sets that see them: the facility's where their own survey points fix it
/// there, else that of the seed's rig (paper §III-F.1).
[[nodiscard]] BuiltSubMap built_submap_of(const IncrementalMapper& mapper,
                                          const CalibratedEstimate& calibrated,
                                          const BuildOptions& options, const Component& component);

/// Whether survey points on the markers fix all six freedoms of their world, which the calibration
/// has laid into the facility's.
[[nodiscard]] bool stands_in_facility(const Observations& observations,
                                      const CalibratedEstimate& calibrated,
                                      const Component& component);

}  // namespace waymark
