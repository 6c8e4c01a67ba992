#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "core/base/range.h"
#include "core/camera/camera_model.h"

namespace waymark {

/// A number of a lens.
struct LensCoefficient {
  std::string_view name;
  Range range;        ///< what it may be
  double plain = 0;   ///< what it is where nothing is known of the lens
  double usual = 0;   ///< what lenses have, and
  double spread = 0;  ///< how far they differ from that: one standard deviation
};

/// What is to be known of a kind of lens beside its equations: a row per kind, which readers,
/// writers, refinement and calibration ask instead of asking which kind it is.
struct LensKind {
  Distortion distortion = Distortion::none;
  std::string_view name;              ///< of the kind: see to_string
  std::string_view camera_model;      ///< Kalibr's
  std::string_view distortion_model;  ///< Kalibr's
  std::span<const LensCoefficient> coefficients;
  /// The first coefficient that bends: rig_parameters' k1. −1 of a straight lens. xi of a double
  /// sphere scales the image, so that it is alpha there.
  int first_bend = -1;

  [[nodiscard]] int count() const { return static_cast<int>(coefficients.size()); }
  /// Whether the coefficients stand with the intrinsics, before fu (Kalibr's eucm and ds).
  [[nodiscard]] bool in_intrinsics() const { return camera_model != "pinhole"; }
};

/// All of them, in the order of Distortion.
[[nodiscard]] std::span<const LensKind> lens_kinds();
[[nodiscard]] const LensKind& lens_kind(Distortion distortion);

/// Of a lens of that kind of which nothing is known: the pinhole's, of equidistant θd = θ.
[[nodiscard]] LensCoefficients plain_coefficients(Distortion distortion);

/// Of lenses as they are: where to look for one.
[[nodiscard]] LensCoefficients usual_coefficients(Distortion distortion);

/// The least of radtan, radtan5 and rational that holds OpenCV's list of coefficients, of which
/// zeros at the end say nothing; nullopt for fewer than four and where a ninth is not zero.
[[nodiscard]] std::optional<Distortion> radial_kind_of(std::span<const double> coefficients);

/// Whether a kind's image may end beyond 90° from the axis: equidistant, eucm, double_sphere.
[[nodiscard]] bool bends_by_angle(Distortion distortion);

/// Focal length at the axis as a share of fu and fv: of a double sphere 1/(1 + xi), else 1.
[[nodiscard]] double focal_share_at_axis(const CameraParameters& parameters);

/// Whether a camera is a pinhole, whatever the kind of its lens.
[[nodiscard]] bool is_straight(const CameraParameters& parameters);

}  // namespace waymark
