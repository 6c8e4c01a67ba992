#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/capture/detection.h"
#include "core/estimate/marker_observation.h"

namespace waymark {

/// One detection of a mapped marker, on its way into a pose.
struct SetObservation {
  MarkerObservation observation;    ///< corners as they would be at the set's stamp
  ImageCorners detected_px;         ///< as detected
  CornerCovariances stated;         ///< the detector's (px²); zero when it states none
  std::array<double, 4> after_s{};  ///< each corner's instant less the set's stamp
  std::array<double, 4> row{};      ///< where its row lies, from the first (−½) to the last (½)
  std::size_t map_index = 0;
  std::size_t report_index = 0;  ///< into PoseEstimate::observations
  bool inlier = false;
  double sigmas_squared = 0;  ///< at the pose; 8 degrees of freedom
  double rms_px = 0;          ///< NaN when a corner can't be projected

  /// Whether some corner was seen at another instant than the set's.
  [[nodiscard]] bool timed() const {
    return std::any_of(after_s.begin(), after_s.end(), [](double t) { return t != 0; });
  }
};

/// Where the marker lies, from the first row (−½) to the last (½).
[[nodiscard]] inline double mean_row(const SetObservation& o) {
  return (o.row[0] + o.row[1] + o.row[2] + o.row[3]) / 4;
}

/// Covariance of its corners' noise (px²): the detector's, and what the model adds.
[[nodiscard]] inline Eigen::Matrix<double, 8, 8> noise_covariance(const SetObservation& o,
                                                                  double noise_px) {
  Eigen::Matrix<double, 8, 8> covariance =
      noise_px * noise_px * Eigen::Matrix<double, 8, 8>::Identity();
  for (Eigen::Index i = 0; i < 4; ++i) {
    covariance.block<2, 2>(2 * i, 2 * i) += o.stated[static_cast<std::size_t>(i)];
  }
  return covariance;
}

}  // namespace waymark
