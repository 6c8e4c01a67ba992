#pragma once

#include <optional>
#include <vector>

#include "core/estimate/consider_parameters.h"
#include "mapbuilder/bundle/marker_covariances.h"

namespace waymark {

/// The normal equations of markers and considered parameters, rig poses eliminated.
struct ConsiderEquations {
  MarkerInformation markers;   ///< N, the markers' own
  Eigen::MatrixXd mixed;       ///< M, six rows a marker, one column a parameter
  Eigen::MatrixXd parameters;  ///< Q, by observations and survey, without any prior
  Eigen::VectorXd gradient;    ///< of the markers, then of the parameters
};

/// The bundle problem of a finished estimate with all that is considered freed: it says how markers
/// would answer. Columns are ConsiderParameters::all and then what a refinement has estimated
/// beside them (the ratio of focal lengths, further lens coefficients).
class ConsiderProblem {
 public:
  /// Of the problem's accepted observations; what its scope has variable was estimated, the rest is
  /// considered. What `problem` points to must outlive this.
  ConsiderProblem(const BundleProblem& problem, const Estimate& estimate, int threads);
  ConsiderProblem(const ConsiderProblem&) = delete;
  ConsiderProblem& operator=(const ConsiderProblem&) = delete;

  /// Of the estimate's rigs and the stated sizes.
  [[nodiscard]] const ConsiderParameters& parameters() const { return parameters_; }
  [[nodiscard]] const std::vector<Rig>& rigs() const { return rigs_; }
  [[nodiscard]] Eigen::Index columns() const { return basis_.cols(); }

  /// Prior covariance of the columns; 0 of those beyond the parameters.
  [[nodiscard]] Eigen::MatrixXd prior() const;
  /// Per column whether it was estimated.
  [[nodiscard]] const std::vector<char>& estimated() const { return estimated_; }
  /// Information of whatever held columns where they were stated while they were estimated.
  [[nodiscard]] const Eigen::MatrixXd& held() const { return held_; }

  /// At the estimate, over the frame sets of `half`.
  [[nodiscard]] ConsiderEquations equations(FrameSetHalf half = FrameSetHalf::all);

  /// What steps of markers and columns leave: the 90 % quantile of squared corners (sigmas²). Good
  /// after `equations` of all frame sets.
  [[nodiscard]] double residuals_after(const Eigen::VectorXd& markers,
                                       const Eigen::VectorXd& columns) const;

 private:
  void take_rigs(const Observations& observations, const Calibration& calibration);
  void take_parameters(const Selection& selection);
  void make_basis(const VariableCalibration& estimated);
  [[nodiscard]] Eigen::VectorXd direction_of(const ConsiderParameter& parameter) const;
  [[nodiscard]] bool is_estimated(const ConsiderParameter& parameter,
                                  const VariableCalibration& estimated) const;
  void add_extras();
  void take_calibration_factors();
  [[nodiscard]] CameraIndex camera_of(const ConsiderParameter& parameter) const;
  [[nodiscard]] double corner_quantile(const BundleVariables& at) const;

  BundleProblem problem_;
  int threads_;
  ReducedProblem reduced_;
  std::vector<Rig> rigs_;
  ConsiderParameters parameters_;
  std::vector<char> estimated_;
  Eigen::MatrixXd basis_;  ///< rows of the calibration blocks by columns
  Eigen::MatrixXd held_;
  Eigen::MatrixXd prior_information_;  ///< of the calibration's rows by factors on these alone
};

}  // namespace waymark
