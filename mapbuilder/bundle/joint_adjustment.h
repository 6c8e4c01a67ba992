#pragma once

#include <memory>
#include <span>

#include "mapbuilder/bundle/direction_hold.h"
#include "mapbuilder/bundle/joint_problem.h"
#include "mapbuilder/bundle/survey_factors.h"
#include "mapbuilder/import/survey.h"

namespace waymark {

/// A direction of the calibration that the data can't tell: held where the rig file has it.
struct HeldDirection {
  std::vector<Vector6d> extrinsics;    ///< weights per camera, of rig_from_cam's tangent
  std::vector<Intrinsics> intrinsics;  ///< per camera, of fu fv pu pv and the four coefficients
};

/// What an adjustment rests on and moves beside observations and poses.
struct AdjustmentScope {
  FreeCalibration free;
  const Survey* survey = nullptr;  ///< its fit entries are residuals
  /// Per marker of the table: the number of its world, kFacilityWorld that of the survey, where
  /// points hold too. Empty: one world, not the survey's.
  std::vector<int> world_of_marker;
  /// One standard deviation of a stated size, as a share of it. (1e-4–0.1) Printers scale by up to
  /// 1 %.
  double size_sigma = 0.01;
  /// One standard deviation of a camera's edge bias (px). (0.01–2) Detectors differ by 0.5 px.
  double edge_bias_sigma_px = 0.5;
  std::vector<HeldDirection> held_directions;
  std::vector<RigCamera> stated_cameras;  ///< of all rigs: where held directions are held

  [[nodiscard]] bool in_facility(int marker) const {
    return !world_of_marker.empty() &&
           world_of_marker[static_cast<std::size_t>(marker)] == kFacilityWorld;
  }
};

/// The scope's residuals beside the corners': survey, priors, held directions, on what takes part
/// in the problem.
[[nodiscard]] std::vector<std::unique_ptr<KeptFactor>> factors_of(const AdjustmentScope& scope,
                                                                  const ObservationTable& table,
                                                                  const JointProblem& problem);

/// How sure an adjustment is of what it has calibrated: one standard deviation each; infinite where
/// nothing is determined.
struct CameraUncertainty {
  double position_m = 0;
  double rotation_rad = 0;
  double focal = 0;  ///< as a share of the focal length
  double edge_bias_px = 0;
};
struct CalibrationUncertainty {
  std::vector<CameraUncertainty> cameras;  ///< of all rigs, one after the other
  std::vector<double> size_factor;         ///< per size class, by rising stated size
  /// Joint covariance of the rig file's numbers: per camera six of the extrinsics, then per camera
  /// eight of the intrinsics; zero where nothing is free. Empty when nothing is determined.
  Eigen::MatrixXd joint;
};

/// Options of the joint adjustment.
struct AdjustmentOptions {
  ObservationLoss loss;
  int max_iterations = 50;           ///< (1–1000)
  double function_tolerance = 1e-6;  ///< relative decrease of the cost that ends it
  /// Levenberg–Marquardt's damping at the start, relative to the diagonal, (1e-16–1). What bends a
  /// large map hardly costs anything: only next to no damping lets the end of an adjustment
  /// converge in such a direction.
  double initial_damping = 1e-6;
  int threads = 1;  ///< ≥ 1; never changes the result
  AdjustmentScope scope{};
};

/// How an adjustment ended.
struct AdjustmentSummary {
  bool converged = false;
  int iterations = 0;
  double initial_cost = 0;  ///< ½ Σ ρ, sigmas²
  double final_cost = 0;
  std::size_t observations = 0;                       ///< that took part
  std::optional<CalibrationUncertainty> uncertainty;  ///< of what was free
};

/// Equation 11: all placed markers and all localized frame sets together, by Levenberg–Marquardt
/// over the reduced marker system; extrinsics, intrinsics and sizes fixed unless the scope frees
/// them. Uses the given observations as far as both their ends are posed, they are accepted and not
/// grossly off, and their frame set has at least two of them (a single one only fixes its own rig).
/// Updates the poses of the state that are not held and, where the calibration is free, the table's
/// rigs, sizes, corners and IPPE solutions.
AdjustmentSummary adjust_jointly(ObservationTable& table, std::span<const std::size_t> observations,
                                 const HeldPoses& held, const AdjustmentOptions& options,
                                 MapState& state);

}  // namespace waymark
