#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mapbuilder/report/report.h"

namespace waymark {

/// Corner residuals (length, px) counted in bins of equal width from 0 on.
struct ResidualHistogram {
  double bin_px = 0;
  std::vector<std::size_t> accepted;
  std::vector<std::size_t> rejected;
  std::size_t accepted_beyond = 0;  ///< beyond the last bin
  std::size_t rejected_beyond = 0;
};

/// Accepted corners whose distance from the principal point lies in [from_px, to_px).
struct RadiusBin {
  double from_px = 0;
  double to_px = 0;
  std::size_t corners = 0;
  double rms_px = 0;
  double mean_radial_px = 0;      ///< positive: seen farther out than predicted
  double mean_tangential_px = 0;  ///< positive: seen farther round, from image x to image y
};

/// Accepted corners in one cell of the image.
struct ImageCell {
  std::size_t corners = 0;
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
};

/// One camera's residuals.
struct CameraResiduals {
  std::size_t observations = 0;  ///< accepted and rejected
  std::size_t rejected = 0;
  double rms_px = 0;                                  ///< over accepted corners
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();  ///< over accepted corners
  std::vector<RadiusBin> by_radius;
  int columns = 0;  ///< of the grid that covers the image
  int rows = 0;
  std::vector<ImageCell> cells;  ///< row by row
};

/// What the residuals of a whole build say.
struct ResidualStatistics {
  std::size_t corners = 0;  ///< accepted
  double rms_px = 0;        ///< accepted
  double median_px = 0;     ///< of the accepted corners' residual lengths
  double quantile90_px = 0;
  ResidualHistogram histogram;
  std::vector<RadiusBin> by_radius;        ///< all cameras together
  std::vector<CameraResiduals> by_camera;  ///< as `cameras`
};

/// Counts and averages. Observations must name cameras that are there (checked).
[[nodiscard]] ResidualStatistics residual_statistics(
    std::span<const ReportObservation> observations, std::span<const ReportCamera> cameras);

/// The smallest of 1, 2 and 5 times a power of ten that is not below `value` (> 0).
[[nodiscard]] double round_step(double value);

}  // namespace waymark
