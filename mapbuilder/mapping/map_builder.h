#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/map/marker_map.h"
#include "mapbuilder/mapping/growth.h"
#include "mapbuilder/mapping/joint_adjustment.h"
#include "mapbuilder/mapping/noise_model.h"
#include "mapbuilder/mapping/outlier_gate.h"
#include "mapbuilder/mapping/survey_factors.h"

namespace waymark {

/// A refinement less sure than this is refused (one standard deviation).
struct RefinementLimits {
  double position_m = 0.002;       ///< (1e-5–1)
  double rotation_rad = 0.001745;  ///< (1e-5–0.1) 0.1°
  double focal = 0.003;            ///< (1e-5–0.1) as a share of the focal length
  double size = 0.003;             ///< (1e-5–0.1) as a share of the stated size
};

/// Of the cost, the share that must go when something of the rig file is freed before it is said
/// not to fit: noise gives up a few per mille. (0.5–0.99)
inline constexpr double kExplainsTooLittle = 0.9;

/// How a calibration that was free ended.
struct CalibrationResult {
  std::vector<std::string> refused;  ///< reasons; empty: the refinement stands
  /// Directions that the data can't tell, held where the rig file has them; the rest is refined.
  std::vector<std::string> held;
  CalibrationUncertainty uncertainty;
  std::vector<Rig> rigs_before;  ///< of the table
  std::vector<Rig> rigs_fitted;
  bool applied = false;  ///< the map is built with what was fitted; else it is evidence only
  /// Robust cost with freed extrinsics to that without, and with freed intrinsics on top of them.
  double extrinsics_cost_ratio = 1.0;
  double intrinsics_cost_ratio = 1.0;
};

/// Options of a build. Defaults are what `mapbuilder build` uses.
struct BuildOptions {
  NoiseModel noise;      ///< its model_sigma_px is the start; it is estimated from the residuals
  ObservationLoss loss;  ///< of Algorithms 1 and 2
  GateOptions gate;
  GrowthOptions growth;
  Survey survey;           ///< measured on site; may be empty
  FreeCalibration refine;  ///< extrinsics, intrinsics, sizes: what the user asks for
  RefinementLimits refinement_limits;
  int max_passes = 8;  ///< (1–50) of adjust, reconsider, gate
  int threads = 0;     ///< 0 = all processors; never changes the result
};

/// A frame set with a pose.
struct LocalizedFrameSet {
  int frame_set = 0;  ///< index in the table
  Rigid3 world_from_rig;
};

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
  double model_sigma_px = 0;                     ///< estimated, per axis
  std::size_t observations = 0;                  ///< of mapped markers in localized frame sets
  std::size_t rejected = 0;                      ///< of these, by the gate
  std::optional<CalibrationResult> calibration;  ///< when something was free
  std::vector<SurveyResidual> survey;
  bool settled = false;            ///< converged, with gate, flips and noise at rest
  bool covariances_known = false;  ///< false: the map's covariances are zero and mean nothing
};

/// What a build gives.
struct BuildResult {
  MarkerMap map;
  std::vector<BuiltSubMap> submaps;  ///< in the map's order
  std::vector<MarkerId> unmapped;    ///< seen, but no pose could be trusted
  std::vector<int> unlocalized;      ///< frame sets with observations but without a pose
  std::vector<int> without_markers;  ///< frame sets without a usable observation
};

/// Builds the map of all captures in the table: components, growth (Algorithm 2), joint adjustment
/// (eq. 11), reconsideration of flips, outlier gate, covariances. Overwrites the table's whitening.
[[nodiscard]] BuildResult build_map(ObservationTable& table, const BuildOptions& options,
                                    Progress& progress);

}  // namespace waymark
