#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/bundle/prepared_observations.h"

namespace waymark {

/// What the finished map leaves of one observation.
struct ObservationResidual {
  ObservationIndex observation;
  bool accepted = false;                      ///< by the gate
  std::array<Eigen::Vector2d, 4> corners_px;  ///< observed less predicted
};

/// Sums of squared corner residuals over observations.
struct ResidualSum {
  double squared_px2 = 0;
  std::size_t corners = 0;
  /// A corner counts as `most_px` off at most: near the camera plane a wrong id's is as far off as
  /// one likes, and says nothing more.
  void add(const std::array<Eigen::Vector2d, 4>& residuals, double most_px);
  [[nodiscard]] double rms_px() const {
    return corners == 0 ? 0.0 : std::sqrt(squared_px2 / static_cast<double>(corners));
  }
};

/// How well a marker's observations fit.
struct MarkerResiduals {
  ResidualSum inliers;
  std::uint32_t accepted = 0;
  std::uint32_t rejected = 0;
  /// Accepted views by rigs that other markers place as well: only these can contradict a marker's
  /// place. A camera that stands still gives one view, however many images.
  std::uint32_t independent = 0;
  std::optional<ObservationIndex> first_independent;
};

/// How well the observations of a sub-map fit.
struct SubMapResiduals {
  std::vector<ObservationResidual> each;  ///< of those that have a prediction
  ResidualSum inliers;
  ResidualSum all;
  std::size_t rejected = 0;
  IndexedVector<MarkerIndex, MarkerResiduals> of_marker;
};

/// Of the given observations, which must be posed.
[[nodiscard]] SubMapResiduals residuals_of(const PreparedObservations& prepared,
                                           const Estimate& estimate,
                                           std::span<const ObservationIndex> observations);

}  // namespace waymark
