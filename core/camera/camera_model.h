#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// Lens distortion, named as Kalibr names it.
enum class Distortion { none, radtan, equidistant };

[[nodiscard]] std::string_view to_string(Distortion distortion);

/// What a camera model is made of. Pixels; (0, 0) is the centre of the top-left pixel.
struct CameraParameters {
  int width_px = 0;
  int height_px = 0;
  double fu_px = 0, fv_px = 0;  ///< focal lengths, > 0
  double pu_px = 0, pv_px = 0;  ///< principal point
  Distortion distortion = Distortion::none;
  std::array<double, 4> coefficients{};  ///< radtan: k1 k2 p1 p2; equidistant: k1 k2 k3 k4

  bool operator==(const CameraParameters&) const = default;
};

/// A point's image with its derivatives.
struct Projection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> d_pixel_d_point;  ///< px per m, point in the camera frame
};

/// Order: fu fv pu pv, then the four coefficients.
using IntrinsicsJacobian = Eigen::Matrix<double, 2, 8>;

/// Projection of the camera frame (x right, y down, z forward, m) to pixels and back.
///
/// Domain: none and radtan take points in front of the camera (z > 0) whose undistorted radius lies
/// where the radial polynomial still grows; equidistant takes any direction whose angle from the
/// axis lies where its polynomial still grows, beyond 90° where the polynomial allows. Outside,
/// functions return nullopt; they never return a wrong pixel.
class CameraModel {
 public:
  /// bad_data when sizes or focal lengths are not positive, a number is not finite, or the image's
  /// corners can't be undistorted by less than the image's half diagonal (coefficients of another
  /// lens). Of fisheyes, whose polynomial often ends before the corners, the middles of the image's
  /// edges are asked instead: pixels beyond have no bearing.
  [[nodiscard]] static Expected<CameraModel> create(const CameraParameters& parameters);

  [[nodiscard]] const CameraParameters& parameters() const { return parameters_; }

  /// Pixel of a point in the camera frame (may lie outside the image); nullopt outside the domain.
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& x_in_cam) const;

  /// The same with derivatives; `d_intrinsics` (optional) receives d pixel / d intrinsics.
  [[nodiscard]] std::optional<Projection> project_with_jacobian(
      const Eigen::Vector3d& x_in_cam, IntrinsicsJacobian* d_intrinsics = nullptr) const;

  /// Unit direction in the camera frame that projects to `pixel`, by Newton's method to 1e-12 rad;
  /// nullopt where no direction of the domain does.
  [[nodiscard]] std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& pixel) const;

  /// Whether the pixel lies in the image: [-0.5, width − 0.5) × [-0.5, height − 0.5).
  [[nodiscard]] bool in_image(const Eigen::Vector2d& pixel) const;

 private:
  explicit CameraModel(const CameraParameters& parameters);

  CameraParameters parameters_;
  double max_radius_;  ///< none, radtan: largest r = |x/z| of the domain; may be infinite
  double max_theta_;   ///< equidistant: largest angle from the axis (rad), ≤ π
};

}  // namespace waymark
