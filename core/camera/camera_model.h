#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// How a lens departs from the pinhole; lens_kind.h says how files name each.
enum class Distortion {
  none,
  radtan,         ///< k1 k2 p1 p2 (Brown)
  radtan5,        ///< + k3
  rational,       ///< + k4 k5 k6, OpenCV's order
  equidistant,    ///< k1 k2 k3 k4 (Kannala and Brandt)
  eucm,           ///< alpha beta: extended unified camera model (Khomutenko et al., 2016)
  double_sphere,  ///< xi alpha (Usenko et al., 2018)
};

/// "none", "radtan", …: for people; two kinds have no name in common.
[[nodiscard]] std::string_view to_string(Distortion distortion);

/// Of the kind with the most; the others leave the last ones zero.
inline constexpr int kMaxCoefficients = 8;
using LensCoefficients = std::array<double, kMaxCoefficients>;

/// What a camera model is made of. Pixels; (0, 0) is the centre of the top-left pixel.
struct CameraParameters {
  int width_px = 0;
  int height_px = 0;
  double fu_px = 0, fv_px = 0;  ///< focal lengths, > 0 (of a double sphere: times 1 + xi)
  double pu_px = 0, pv_px = 0;  ///< principal point
  Distortion distortion = Distortion::none;
  LensCoefficients coefficients{};  ///< in the order of Distortion
  /// Stated: farther from the principal point the calibration says nothing.
  std::optional<double> valid_radius_px{};

  bool operator==(const CameraParameters&) const = default;
};

/// A point's image with its derivatives.
struct Projection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> d_pixel_d_point;  ///< px per m, point in the camera frame
};

/// fu fv pu pv, then the coefficients.
inline constexpr int kIntrinsicNumbers = 4 + kMaxCoefficients;
using IntrinsicsVector = Eigen::Matrix<double, kIntrinsicNumbers, 1>;
using IntrinsicsJacobian = Eigen::Matrix<double, 2, kIntrinsicNumbers>;

[[nodiscard]] IntrinsicsVector intrinsics_of(const CameraParameters& parameters);
/// The same camera with other intrinsics.
[[nodiscard]] CameraParameters with_intrinsics(CameraParameters parameters,
                                               const IntrinsicsVector& intrinsics);

/// Projection of the camera frame (x right, y down, z forward, m) to pixels and back.
///
/// Domain: where a lens is one-to-one. none, radtan and rational take points in front of the camera
/// (z > 0) whose undistorted radius lies where the radial polynomial still grows; equidistant any
/// direction whose angle from the axis lies where its polynomial still grows, beyond 90° where the
/// polynomial allows; eucm and double_sphere any direction where their radius still grows. Outside,
/// functions return nullopt; they never return a wrong pixel.
class CameraModel {
 public:
  /// bad_data when sizes or focal lengths are not positive, a number is not finite or outside its
  /// range (alpha 0–1, beta above 0, xi −0.99–1, valid radius above 0), or the domain ends so near
  /// the axis that the coefficients are another lens's (valid_radius_px() below 0.4 of the image's
  /// half diagonal).
  [[nodiscard]] static Expected<CameraModel> create(const CameraParameters& parameters);

  [[nodiscard]] const CameraParameters& parameters() const { return parameters_; }

  /// Pixel of a point in the camera frame (may lie outside the image); nullopt outside the domain.
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& x_in_cam) const;

  /// The same with derivatives; `d_intrinsics` (optional) receives d pixel / d intrinsics.
  [[nodiscard]] std::optional<Projection> project_with_jacobian(
      const Eigen::Vector3d& x_in_cam, IntrinsicsJacobian* d_intrinsics = nullptr) const;

  /// Unit direction in the camera frame that projects to `pixel`, to 1e-12 rad; nullopt where no
  /// direction of the domain does.
  [[nodiscard]] std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& pixel) const;

  /// Whether the pixel lies in the image: [-0.5, width − 0.5) × [-0.5, height − 0.5).
  [[nodiscard]] bool in_image(const Eigen::Vector2d& pixel) const;

  /// How far from the principal point the calibration says something: as stated, and no farther
  /// than 2 % inside the domain's end, where a pixel of error is degrees of direction; infinite
  /// where that is nowhere in the image.
  [[nodiscard]] double valid_radius_px() const { return valid_radius_px_; }
  /// Whether it does there: what is seen elsewhere is no measurement.
  [[nodiscard]] bool covers(const Eigen::Vector2d& pixel) const {
    const double x = pixel.x() - parameters_.pu_px;
    const double y = pixel.y() - parameters_.pv_px;
    return x * x + y * y <= valid_radius_px_ * valid_radius_px_;
  }
  /// Whether it does at all of them.
  template <typename Pixels>
  [[nodiscard]] bool covers_all(const Pixels& pixels) const {
    for (const Eigen::Vector2d& pixel : pixels) {
      if (!covers(pixel)) return false;
    }
    return true;
  }

 private:
  explicit CameraModel(const CameraParameters& parameters);

  CameraParameters parameters_;
  double domain_end_;  ///< as the lens's own file has it: a radius, an angle or a cosine
  double valid_radius_px_ = std::numeric_limits<double>::infinity();
};

}  // namespace waymark
