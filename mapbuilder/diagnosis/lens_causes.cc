#include "mapbuilder/diagnosis/lens_causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/camera/lens_kind.h"

namespace waymark {
namespace {

/// What a calibration that is right may leave: a share of the focal length, and px.
constexpr double kSameFocal = 0.02;
constexpr double kSame_px = 2.0;
/// How near two principal points are one where a cause is told by it, as a share of the width:
/// where markers fill little of the image, it trades against their poses.
constexpr double kSamePoint = 0.02;

constexpr const char* kCalibrate = "Calibrate the camera anew, or build with --refine intrinsics.";

double focal_of(const CameraParameters& p) {
  return focal_share_at_axis(p) * std::sqrt(p.fu_px * p.fv_px);
}

bool near(double a, double b, double share) { return std::abs(a / b - 1.0) <= share; }

/// How far the lens moves the image's points from where a straight one has them, at most over the
/// image (px).
double bend_px(const CameraParameters& p) {
  CameraParameters straight = p;
  straight.distortion = Distortion::none;
  straight.coefficients = {};
  straight.fu_px *= focal_share_at_axis(p);
  straight.fv_px *= focal_share_at_axis(p);
  const auto bent = CameraModel::create(p);
  const auto plain = CameraModel::create(straight);
  if (!bent || !plain) return 0;
  double most = 0;
  for (const double u : {0.05, 0.5, 0.95}) {
    for (const double v : {0.05, 0.5, 0.95}) {
      const auto ray = plain->bearing({u * p.width_px, v * p.height_px});
      const auto pixel = ray ? bent->project(*ray) : std::nullopt;
      if (pixel) {
        most = std::max(most, (*pixel - Eigen::Vector2d(u * p.width_px, v * p.height_px)).norm());
      }
    }
  }
  return most;
}

/// The fitted numbers are the stated ones as [cx cy fx fy].
bool another_order(const CameraParameters& stated, const CameraParameters& fitted) {
  return near(fitted.fu_px, stated.pu_px, 0.05) && near(fitted.fv_px, stated.pv_px, 0.05) &&
         !near(fitted.fu_px, stated.fu_px, 0.05);
}

/// The simple factor by which the fitted numbers are the stated ones of another resolution.
std::optional<double> scale_of(const CameraParameters& stated, const CameraParameters& fitted) {
  const double ratio = focal_of(fitted) / focal_of(stated);
  for (const double factor :
       {2.0, 0.5, 4.0, 0.25, 1.5, 2.0 / 3.0, 3.0, 1.0 / 3.0, 4.0 / 3.0, 0.75}) {
    const Eigen::Vector2d scaled((stated.pu_px + 0.5) * factor - 0.5,
                                 (stated.pv_px + 0.5) * factor - 0.5);
    const Eigen::Vector2d off = scaled - Eigen::Vector2d(fitted.pu_px, fitted.pv_px);
    if (near(ratio, factor, 0.03) && off.norm() < 0.06 * fitted.width_px) return factor;
  }
  return std::nullopt;
}

/// A principal point that no lens has, in words: of intrinsics such as [fu pu fv pv].
std::optional<std::string> point_outside(const CameraParameters& stated) {
  if (stated.pu_px >= 0 && stated.pu_px < stated.width_px && stated.pv_px >= 0 &&
      stated.pv_px < stated.height_px) {
    return std::nullopt;
  }
  return fmt::format(
      "the stated principal point, ({:.0f}, {:.0f}), lies outside of the image of {} x {}: are the "
      "intrinsics written in another order?",
      stated.pu_px, stated.pv_px, stated.width_px, stated.height_px);
}

std::string factor_text(double factor) {
  if (factor == 2.0) return "half the resolution";
  if (factor == 0.5) return "double the resolution";
  return fmt::format("{:.3g} of the resolution", 1.0 / factor);
}

}  // namespace

std::optional<LensExplanation> explain_lens(const CameraParameters& stated,
                                            const CameraParameters& fitted) {
  LensExplanation e;
  if (another_order(stated, fitted)) {
    e.unit = "px";
    e.value = fitted.fu_px;
    e.detail = fmt::format(
        "images fit a focal length of {:.0f} px, which is stated as the principal point: are "
        "the intrinsics written as [cx cy fx fy]?",
        focal_of(fitted));
    e.remedy = "Write them as [fu fv pu pv].";
    return e;
  }
  if (const auto factor = scale_of(stated, fitted)) {
    e.cause = Cause::resolution;
    e.unit = "%";
    e.value = 100.0 * (focal_of(fitted) / focal_of(stated) - 1.0);
    e.detail = fmt::format(
        "images fit a focal length {:+.1f} % off the stated one: as of {} of the images", e.value,
        factor_text(*factor));
    e.remedy = "Use the calibration of the size that is recorded, or scale its intrinsics.";
    return e;
  }
  if (const auto lies_outside = point_outside(stated)) {
    e.unit = "px";
    e.value = fitted.fu_px;
    e.detail = *lies_outside;
    e.remedy = "Check the order of intrinsics: fu, fv, pu, pv.";
    return e;
  }
  const double aspect = (fitted.fv_px / fitted.fu_px) / (stated.fv_px / stated.fu_px);
  if (std::abs(aspect - 1.0) > kSameFocal) {
    e.cause = Cause::resolution;
    e.unit = "%";
    e.value = 100.0 * (aspect - 1.0);
    e.detail = fmt::format("fv fits {:.1f} % {} fu: were images scaled in one direction?",
                           std::abs(e.value), aspect < 1 ? "below" : "above");
    e.remedy = "Record at the camera's own aspect, or calibrate what is recorded.";
    return e;
  }
  const double focal = focal_of(fitted) / focal_of(stated) - 1.0;
  const Eigen::Vector2d shift(fitted.pu_px - stated.pu_px, fitted.pv_px - stated.pv_px);
  if (std::abs(focal) > kSameFocal) {
    e.unit = "%";
    e.value = 100.0 * focal;
    e.detail = fmt::format("images fit a focal length {:+.1f} % off the stated one", e.value);
    e.remedy = kCalibrate;
    return e;
  }
  if (shift.norm() > 2 * kSame_px) {
    const Eigen::Vector2d turned(stated.width_px - 1 - 2 * stated.pu_px,
                                 stated.height_px - 1 - 2 * stated.pv_px);
    e.unit = "px";
    e.value = shift.norm();
    const double alike_px =
        std::clamp(0.35 * turned.norm(), kSame_px, kSamePoint * stated.width_px);
    if ((shift - turned).norm() < alike_px) {
      e.cause = Cause::images_turned;
      e.detail = fmt::format(
          "the principal point fits at ({:.1f}, {:.1f}), which is the stated one turned by 180°: "
          "are the images turned?",
          fitted.pu_px, fitted.pv_px);
      e.remedy = "Switch the turning off in the driver, or calibrate with it.";
      return e;
    }
    if (shift.norm() > kSamePoint * stated.width_px) {
      e.cause = Cause::crop;
      e.detail = fmt::format(
          "the principal point fits at ({:.1f}, {:.1f}), ({:+.1f}, {:+.1f}) px from the stated "
          "one: a crop of what was calibrated?",
          fitted.pu_px, fitted.pv_px, shift.x(), shift.y());
      e.remedy = "Calibrate the crop, or shift the principal point by its offset.";
      return e;
    }
  }
  const double stated_bend = bend_px(stated);
  const double fitted_bend = bend_px(fitted);
  if (stated_bend > 2 * kSame_px && fitted_bend < 0.2 * stated_bend) {
    e.cause = Cause::rectified;
    e.unit = "px";
    e.value = stated_bend;
    e.detail = fmt::format(
        "images fit a lens without distortion, and the stated one bends them by up to {:.1f} "
        "px: were they rectified?",
        stated_bend);
    e.remedy = "State distortion_model none with the intrinsics of the rectified images.";
    return e;
  }
  if (std::abs(fitted_bend - stated_bend) > kSame_px || shift.norm() > 2 * kSame_px) {
    e.unit = "px";
    e.value = std::max(std::abs(fitted_bend - stated_bend), shift.norm());
    e.detail = fmt::format(
        "images fit another lens or principal point, by up to {:.1f} px in the image", e.value);
    e.remedy = kCalibrate;
    return e;
  }
  return std::nullopt;
}

}  // namespace waymark
