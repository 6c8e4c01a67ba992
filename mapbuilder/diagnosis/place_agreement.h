#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/rigid3.h"

namespace waymark {

/// A place on a marker as the images have it and as it was measured by other means.
struct MeasuredPlace {
  Rigid3 world_from_marker;                               ///< by the images (m)
  double size_m = 0;                                      ///< of the marker
  Eigen::Vector3d x_in_marker = Eigen::Vector3d::Zero();  ///< where on it, as stated (m)
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();     ///< in the other frame, its own unit
  double sigma = 0;                                       ///< of `measured` per axis, in its unit
  double images_sigma_m = 0;                              ///< of the images' place, per axis
};

/// What may be wrong with all measured places alike, the simplest first.
enum class CommonFault {
  none,
  shifted,   ///< another spot of every marker was measured
  mirrored,  ///< one axis runs the other way
  scaled,    ///< another unit, or sizes of another scale
  mirrored_and_scaled,
};

/// How measured places and the images' agree.
struct PlaceAgreement {
  CommonFault fault = CommonFault::none;
  double scale = 1;                                 ///< measured lengths over the images'
  double scale_sigma = 0;                           ///< of its logarithm
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< in each marker's frame, in its sizes
  Rigid3 measured_from_world;  ///< after mirroring (z of the world) and scaling
  std::vector<double> off;     ///< distance from where each was measured, in the measured unit
  std::vector<char> agrees;
  /// Pairs of those that disagree of which each stands where the other was measured.
  std::vector<std::pair<std::size_t, std::size_t>> exchanged;
  /// By which the places scatter more than their sigmas say; 1 at least.
  double noise_scale = 1;
  double gain = 0;  ///< 2 Δ ln L over no common fault, less the price of the numbers freed

  [[nodiscard]] bool mirrors() const {
    return fault == CommonFault::mirrored || fault == CommonFault::mirrored_and_scaled;
  }
  /// Where the images have a place, in the measured frame.
  [[nodiscard]] Eigen::Vector3d predicted(const MeasuredPlace& place) const;
  /// Of a direction of the world, in the measured frame.
  [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& direction) const;
  [[nodiscard]] std::size_t agreeing() const;
};

/// The motion, and the simplest common fault, by which more than half of the places agree (three at
/// least): found over triples of places by the least majority quantile, refined under Welsch's loss
/// at six sigmas. Sigmas grow with what the best explanation leaves. Without a fault the scale is 1
/// ± `scale_sigma`. A fault must gain 10 sigmas² on none, its numbers paid by ln n each. nullopt
/// where the places lie on a line, are fewer than three, or no majority agrees.
[[nodiscard]] std::optional<PlaceAgreement> agreement_of(std::span<const MeasuredPlace> places,
                                                         double scale_sigma);

}  // namespace waymark
