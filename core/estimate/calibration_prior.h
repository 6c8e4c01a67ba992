#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/camera/rig_parameters.h"
#include "core/estimate/error_columns.h"
#include "core/map/marker_map.h"

namespace waymark {

/// What is known, before a set, of the errors that it shares with every other: a mean, zero until
/// something was learnt, with a covariance. Camera by camera the numbers of its calibration, then a
/// factor for each stated size of print, then the map's modes z ~ N(0, I), of which its markers'
/// errors are T z each (MapMarker::modes). Kept in units of usual sigmas, so that numbers of all
/// kinds are alike.
class CalibrationPrior {
 public:
  /// Cameras by what the rig states or else by the defaults of rig_parameters.h. Prints are those
  /// that the map was made of: their errors are its own, and so is what its markers err by with
  /// them. Where `same_calibration` (is_calibration_of) that holds of the cameras, too: their
  /// covariance is then what the map left of it, but for edges that the map knows better
  /// (knows_edges_better). Otherwise rig and map err independently.
  CalibrationPrior(const Rig& rig, const SigmaCircumstances& circumstances, const SubMap& map,
                   bool same_calibration);

  /// Numbers in all.
  [[nodiscard]] Eigen::Index size() const { return covariance_.rows(); }
  /// Those of cameras and sizes, without the modes.
  [[nodiscard]] Eigen::Index numbers() const { return size() - modes_; }
  /// kMapModes, or 0 of a map whose markers share nothing.
  [[nodiscard]] Eigen::Index modes() const { return modes_; }
  [[nodiscard]] std::size_t cameras() const { return cameras_; }
  [[nodiscard]] std::size_t sizes() const { return sizes_m_.size(); }
  [[nodiscard]] static Eigen::Index first_of(std::size_t camera) {
    return static_cast<Eigen::Index>(camera) * kCalibrationNumbers;
  }
  /// Which of the sizes a marker has.
  [[nodiscard]] std::size_t size_of(const MapMarker& marker) const;
  /// Where the factor of a size stands.
  [[nodiscard]] Eigen::Index at_size(std::size_t size) const {
    return first_of(cameras_) + static_cast<Eigen::Index>(size);
  }

  /// In units of usual sigmas.
  [[nodiscard]] const Eigen::VectorXd& mean() const { return mean_; }
  /// Of one number of a camera, in its own unit.
  [[nodiscard]] double mean_of(std::size_t camera, Eigen::Index number) const {
    return mean_[first_of(camera) + number] * units()[number];
  }
  /// Mean and covariance from what was seen; in units of usual sigmas, sized as they are.
  void learn(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance);
  /// The square of the instant at which a camera sees a row (−½ the first, ½ the last) less the
  /// instant that is stated, on average, s².
  [[nodiscard]] double squared_time(std::size_t camera, double row) const {
    const double mean = mean_of(camera, kStamp) + row * mean_of(camera, kReadout);
    const CalibrationVector v = variances_of(camera);
    return mean * mean + v[kStamp] + row * row * v[kReadout];
  }

  /// In units of usual sigmas, squared; positive definite.
  [[nodiscard]] const Eigen::MatrixXd& covariance() const { return covariance_; }
  /// The camera's variances in their own units.
  [[nodiscard]] CalibrationVector variances_of(std::size_t camera) const;
  [[nodiscard]] double size_variance(std::size_t size) const;

  /// Numbers that may be wrong by so much more, independently of all else: `sigmas` in their units.
  void widen(std::size_t camera, const CalibrationVector& sigmas);

  /// The usual sigmas: what one unit is.
  [[nodiscard]] static const CalibrationVector& units();
  static constexpr double kSizeUnit = 1e-3;

 private:
  std::size_t cameras_;
  std::vector<double> sizes_m_;  ///< as stated, rising
  Eigen::Index modes_ = 0;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
};

/// Whether the map was built with this very calibration: `rig_fingerprint` is the rig's, the map
/// considered the rig's numbers, and every serial is the same. In doubt it was not.
[[nodiscard]] bool is_calibration_of(const SubMap& map, const std::string& rig_fingerprint,
                                     const Rig& rig);

/// Whether the map is more than twice as sure of a camera's edges as the rig is: images told them
/// when it was built, and it has moved its corners by that. What is seen with this rig file is not
/// moved so, and errs by all that the rig leaves open.
[[nodiscard]] bool knows_edges_better(const SubMap& map, const Rig& rig, std::size_t camera);

/// Says of the map that its prints' sizes are exact to 1e-9, as a simulator knows them.
void state_exact_sizes(SubMap& map);

}  // namespace waymark
