#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/bundle/constant_direction.h"
#include "mapbuilder/bundle/prepared_observations.h"
#include "mapbuilder/import/survey.h"

namespace waymark {

/// What of the calibration is variable beside the poses.
struct VariableCalibration {
  bool extrinsics = false;  ///< rig_from_cam of every camera but each rig's first
  bool intrinsics = false;  ///< fu fv pu pv and the lens's coefficients of every camera
  bool sizes = false;       ///< one factor per stated size
  bool edge_bias = false;   ///< how far each camera's edges lie outside (px), all alike
  /// With intrinsics: whether a lens stated straight may bend (radtan), or stays straight.
  bool straight_lenses_bend = true;
  /// With intrinsics: so many of each lens's coefficients vary, the first ones. Numerators and
  /// denominators of a rational lens are told apart only once it bends.
  int coefficients = kMaxCoefficients;

  [[nodiscard]] bool any() const { return extrinsics || intrinsics || sizes || edge_bias; }
};

/// The poses that are constant.
struct ConstantPoses {
  std::vector<FrameSetIndex> frame_sets;
  IndexedVector<MarkerIndex, char> markers;  ///< ≠ 0: constant; empty: none

  [[nodiscard]] bool holds(MarkerIndex marker) const {
    return !markers.empty() && markers[marker] != 0;
  }
  [[nodiscard]] bool holds(FrameSetIndex frame_set) const {
    return std::find(frame_sets.begin(), frame_sets.end(), frame_set) != frame_sets.end();
  }
};

/// Number of a world: parts of a map that nothing joins have one each.
using WorldIndex = Index<struct WorldKind>;

/// The world in which a survey's points are given.
inline constexpr WorldIndex kFacilityWorld{0};

/// What an adjustment varies and rests on beside observations and poses.
struct BundleScope {
  VariableCalibration variable;
  const Survey* survey = nullptr;  ///< its fit entries are residuals
  /// Of each marker; kFacilityWorld: that of the survey, where points hold too. Empty: one world,
  /// not the survey's.
  IndexedVector<MarkerIndex, WorldIndex> world_of_marker;
  /// One standard deviation of a stated size, as a share of it. (1e-4–0.1) Printers scale by up to
  /// 1 %.
  double size_sigma = 0.01;
  /// One standard deviation of a camera's edge bias (px). (0.01–2) Detectors differ by 0.5 px.
  double edge_bias_sigma_px = 0.5;
  std::vector<ConstantDirection> constant_directions;
  /// Where the directions are constant.
  IndexedVector<CameraIndex, RigCamera> stated_cameras;

  /// usage, naming the first of the two sigmas that lies outside its range.
  [[nodiscard]] Status check() const;
  [[nodiscard]] bool in_facility(MarkerIndex marker) const {
    return !world_of_marker.empty() && world_of_marker[marker] == kFacilityWorld;
  }
};

/// Equation 11: markers, rigs and, where asked, the calibration that explain the observations best.
/// Of the observations those count that are accepted, not grossly off, posed at both ends, and not
/// alone in their frame set (a single one only fixes its own rig).
struct BundleProblem {
  const PreparedObservations* prepared = nullptr;  ///< by the estimate that is adjusted
  std::vector<ObservationIndex> observations;
  ConstantPoses constant;
  BundleScope scope;
  ObservationLoss loss;
};

/// Those of the problem's observations that count, in their order.
[[nodiscard]] std::vector<ObservationIndex> counting_observations(const BundleProblem& problem,
                                                                  const Estimate& estimate);

/// What solves the problem.
enum class BundleSolver {
  own,    ///< Levenberg–Marquardt over the reduced system; equal bytes whatever the threads
  ceres,  ///< Ceres Solver, slower: a second opinion
};

/// How far an adjustment goes.
struct BundleOptions {
  BundleSolver solver = BundleSolver::own;
  int max_iterations = 50;           ///< (1–1000)
  double function_tolerance = 1e-6;  ///< (1e-16–0.1) relative decrease of the cost that ends it
  /// (1e-16–1) Levenberg–Marquardt's damping at the start, relative to the diagonal. What bends a
  /// large map hardly costs anything: only next to no damping lets the end of an adjustment
  /// converge in such a direction.
  double initial_damping = 1e-6;
  int threads = 1;  ///< (1–1024) never changes what the own solver finds

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Why an adjustment ended.
enum class BundleTermination {
  converged,       ///< nothing is left to win
  no_convergence,  ///< the iterations are used up, or no step lowers the cost any more
  nothing_to_do,   ///< no observation counts
};

/// How an adjustment went.
struct BundleSummary {
  BundleTermination termination = BundleTermination::nothing_to_do;
  int iterations = 0;
  double initial_cost = 0;       ///< ½ Σ ρ, sigmas²
  double final_cost = 0;         ///< ½ Σ ρ, sigmas²
  std::size_t observations = 0;  ///< that count

  /// Whether the estimate is an optimum as far as observations tell.
  [[nodiscard]] bool at_optimum() const { return termination != BundleTermination::no_convergence; }
};

/// How sure an adjustment is of one camera: one standard deviation each; infinite where nothing is
/// determined, 0 for what was constant.
struct CameraUncertainty {
  double position_m = 0;
  double rotation_rad = 0;
  double focal = 0;  ///< as a share of the focal length
  double edge_bias_px = 0;
};

/// How sure an adjustment is of what it has calibrated.
struct CalibrationUncertainty {
  IndexedVector<CameraIndex, CameraUncertainty> cameras;
  std::vector<double> size_factor;  ///< per size class, by rising stated size
  /// Joint covariance of the rig file's numbers: per camera six of the extrinsics, then per camera
  /// kIntrinsicNumbers of the intrinsics; zero where they are constant or the lens has them not.
  /// Empty when nothing is determined.
  Eigen::MatrixXd joint;
};

}  // namespace waymark
