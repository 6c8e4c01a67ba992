#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/detect/marker_plane.h"

namespace waymark {

/// One side of a marker's border in the image: the chord between its ends, and how far the side
/// bends away from it: by the lens as the camera model knows it, and by a bow of its own (paper
/// that is not flat, a lens that is not quite the model's).
class ImageSide {
 public:
  /// The straight line from `start` to `end` (marker plane; the marker's inside lies to the right
  /// as the image shows it), and `bow_px` farther out in its middle. nullopt when it leaves the
  /// camera's domain or is shorter than 1 px.
  [[nodiscard]] static std::optional<ImageSide> create(const MarkerPlane& plane,
                                                       const Eigen::Vector2d& start,
                                                       const Eigen::Vector2d& end, double bow_px);

  [[nodiscard]] const Eigen::Vector2d& start_px() const { return start_px_; }
  [[nodiscard]] Eigen::Vector2d end_px() const { return start_px_ + length_px_ * along_; }
  [[nodiscard]] const Eigen::Vector2d& along() const { return along_; }      ///< unit
  [[nodiscard]] const Eigen::Vector2d& outward() const { return outward_; }  ///< unit
  [[nodiscard]] double length_px() const { return length_px_; }

  /// Place along the side: 0 at its start, 1 at its end.
  [[nodiscard]] double place(const Eigen::Vector2d& pixel) const {
    return along_.dot(pixel - start_px_) / length_px_;
  }
  /// How far (px) the side lies outside of its chord at a place.
  [[nodiscard]] double bend_px(double place) const {
    return place * (1 - place) * (bend_[0] + place * (bend_[1] + place * bend_[2]));
  }
  /// d bend / d place (px).
  [[nodiscard]] double bend_slope_px(double place) const {
    const double cubic = bend_[0] + place * (bend_[1] + place * bend_[2]);
    return (1 - 2 * place) * cubic + place * (1 - place) * (bend_[1] + 2 * place * bend_[2]);
  }
  /// Distance (px) from the side, positive outside the marker.
  [[nodiscard]] double outside_px(const Eigen::Vector2d& pixel) const {
    return outward_.dot(pixel - start_px_) - bend_px(place(pixel));
  }
  [[nodiscard]] Eigen::Vector2d point_px(double place) const {
    return start_px_ + place * length_px_ * along_ + bend_px(place) * outward_;
  }

 private:
  ImageSide() = default;

  Eigen::Vector2d start_px_;
  Eigen::Vector2d along_;
  Eigen::Vector2d outward_;
  double length_px_ = 0;
  std::array<double, 3> bend_{};
};

}  // namespace waymark
