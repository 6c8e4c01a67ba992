#include "mapbuilder/calibration/refinement_support.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/told_apart.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/degrees.h"

namespace waymark {
namespace {

constexpr Eigen::Index kExtrinsics = 6;
constexpr Eigen::Index kIntrinsics = kIntrinsicNumbers;
/// Principal point and lens.
constexpr int kBeyondFocal = kIntrinsicNumbers - 2;
using ImageShift = Eigen::Matrix<double, kBeyondFocal, kBeyondFocal>;

/// RMS over the image of the pixels' shift per change of principal point and lens: the symmetric
/// root of mean JᵀJ.
ImageShift image_shift(const CameraModel& camera) {
  constexpr int kSteps = 8;
  const CameraParameters& p = camera.parameters();
  ImageShift sum = ImageShift::Zero();
  double count = 0;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel(p.width_px * (column + 0.0) / kSteps,
                                  p.height_px * (row + 0.0) / kSteps);
      const auto bearing = camera.bearing(pixel);
      IntrinsicsJacobian jacobian;
      if (!bearing || !camera.project_with_jacobian(*bearing, &jacobian)) continue;
      const auto part = jacobian.rightCols<kBeyondFocal>();
      sum += part.transpose() * part;
      count += 1;
    }
  }
  const SymmetricEigen<Eigen::Dynamic> eigen =
      symmetric_eigen<Eigen::Dynamic>(sum / std::max(1.0, count));
  return eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal() *
         eigen.vectors.transpose();
}

/// The rig file's numbers in units of the limits.
Eigen::MatrixXd per_limit(const IndexedVector<CameraIndex, RigCamera>& cameras,
                          const RefinementLimits& limits) {
  const auto count = static_cast<Eigen::Index>(cameras.size());
  Eigen::MatrixXd scale = Eigen::MatrixXd::Zero((kExtrinsics + kIntrinsics) * count,
                                                (kExtrinsics + kIntrinsics) * count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const RigCamera& camera = cameras[CameraIndex(static_cast<std::size_t>(c))];
    const double fu_px = camera.model.parameters().fu_px;
    const Eigen::Index extrinsics = kExtrinsics * c;
    const Eigen::Index intrinsics = kExtrinsics * count + kIntrinsics * c;
    scale.diagonal().segment<3>(extrinsics).setConstant(1.0 / limits.position_m);
    scale.diagonal().segment<3>(extrinsics + 3).setConstant(1.0 / limits.rotation_rad);
    scale.diagonal().segment<2>(intrinsics).setConstant(1.0 / (limits.focal * fu_px));
    scale.block<kBeyondFocal, kBeyondFocal>(intrinsics + 2, intrinsics + 2) =
        image_shift(camera.model) / (limits.rotation_rad * fu_px);
  }
  return scale;
}

/// What the direction's largest part is, and how sure.
std::string text_of(Eigen::Index row, double in_limits,
                    const IndexedVector<CameraIndex, RigCamera>& cameras,
                    const RefinementLimits& limits) {
  const auto count = static_cast<Eigen::Index>(cameras.size());
  const bool of_extrinsics = row < kExtrinsics * count;
  const Eigen::Index within = of_extrinsics ? row : row - kExtrinsics * count;
  const Eigen::Index size = of_extrinsics ? kExtrinsics : kIntrinsics;
  const std::string& name = cameras[CameraIndex(static_cast<std::size_t>(within / size))].name;
  const auto text = [&](const char* what, double allowed, const char* unit) {
    const auto [known, asked] = told_apart(in_limits * allowed, allowed);
    return fmt::format("{}'s {} with what moves along: known to ± {} {} only, {} is asked for",
                       name, what, known, unit, asked);
  };
  if (of_extrinsics) {
    return within % size < 3 ? text("position", 1e3 * limits.position_m, "mm")
                             : text("orientation", kDegreesPerRadian * limits.rotation_rad, "°");
  }
  return within % size < 2 ? text("focal length", 100 * limits.focal, "%")
                           : text("principal point and lens",
                                  kDegreesPerRadian * limits.rotation_rad, "° of bearing");
}

/// Number of directions of extrinsics or of intrinsics that vary.
Eigen::Index variable_directions(const CalibrationUncertainty& sure, bool of_extrinsics) {
  const auto cameras = static_cast<Eigen::Index>(sure.cameras.size());
  const auto diagonal = sure.joint.diagonal();
  return of_extrinsics ? (diagonal.head(kExtrinsics * cameras).array() > 0).count()
                       : (diagonal.tail(kIntrinsics * cameras).array() > 0).count();
}

void refuse_when_too_much_is_unsure(const CalibrationUncertainty& sure,
                                    const std::vector<UnsureDirection>& unsure, bool of_extrinsics,
                                    const RefinementLimits& limits,
                                    std::vector<std::string>& reasons) {
  const auto alike = [&](const UnsureDirection& d) { return d.of_extrinsics == of_extrinsics; };
  const auto count = std::count_if(unsure.begin(), unsure.end(), alike);
  const Eigen::Index variable = variable_directions(sure, of_extrinsics);
  const auto worst = std::find_if(unsure.rbegin(), unsure.rend(), alike);
  if (count == 0 || (2 * count < variable && worst->in_limits < limits.most_unsure)) return;
  reasons.push_back(fmt::format("{}: {} of {} directions can't be told; {}",
                                of_extrinsics ? "extrinsics" : "intrinsics", count, variable,
                                worst->text));
}

}  // namespace

std::vector<UnsureDirection> unsure_directions(
    const CalibrationUncertainty& sure, const IndexedVector<CameraIndex, RigCamera>& stated_cameras,
    const RefinementLimits& limits) {
  std::vector<UnsureDirection> unsure;
  if (sure.joint.size() == 0) return unsure;
  const auto cameras = static_cast<Eigen::Index>(stated_cameras.size());
  const Eigen::MatrixXd scale = per_limit(stated_cameras, limits);
  const SymmetricEigen<Eigen::Dynamic> eigen =
      symmetric_eigen<Eigen::Dynamic>(scale * sure.joint * scale.transpose());
  for (Eigen::Index i = 0; i < scale.rows(); ++i) {
    if (eigen.values[i] <= 1.0) continue;
    const Eigen::VectorXd along = eigen.vectors.col(i);
    const Eigen::VectorXd weights = scale.transpose() * along;
    UnsureDirection direction;
    for (Eigen::Index c = 0; c < cameras; ++c) {
      direction.direction.extrinsics.push_back(weights.segment<kExtrinsics>(kExtrinsics * c));
      direction.direction.intrinsics.push_back(
          weights.segment<kIntrinsics>(kExtrinsics * cameras + kIntrinsics * c));
    }
    direction.of_extrinsics = along.head(kExtrinsics * cameras).squaredNorm() > 0.5;
    Eigen::Index most = 0;
    along.cwiseAbs().maxCoeff(&most);
    direction.in_limits = std::sqrt(eigen.values[i]);
    direction.text = text_of(most, direction.in_limits, stated_cameras, limits);
    unsure.push_back(std::move(direction));
  }
  return unsure;
}

std::vector<std::string> reasons_against(const VariableCalibration& asked,
                                         const CalibrationUncertainty& sure,
                                         const std::vector<UnsureDirection>& unsure,
                                         const IndexedVector<RigIndex, Rig>& rigs,
                                         const RefinementLimits& limits) {
  std::vector<std::string> reasons;
  const auto one_camera = [](const Rig& rig) { return rig.cameras.size() < 2; };
  if (asked.extrinsics && std::all_of(rigs.begin(), rigs.end(), one_camera)) {
    reasons.emplace_back("extrinsics: a rig of one camera has none");
  }
  if (asked.any() && sure.joint.size() == 0) {
    reasons.emplace_back("some direction can't be told at all, whatever else is held");
    return reasons;
  }
  if (asked.extrinsics) refuse_when_too_much_is_unsure(sure, unsure, true, limits, reasons);
  if (asked.intrinsics) refuse_when_too_much_is_unsure(sure, unsure, false, limits, reasons);
  const auto too_loose = [&](double sigma) { return !(sigma <= limits.size); };
  const auto loose = std::find_if(sure.size_factor.begin(), sure.size_factor.end(), too_loose);
  if (asked.sizes && loose != sure.size_factor.end()) {
    const auto [known, asked_for] = told_apart(100 * *loose, 100 * limits.size);
    reasons.push_back(
        fmt::format("sizes: known to ± {} % only, {} % is asked for: nothing but the stated sizes "
                    "tells the scale; measure a distance (survey.toml)",
                    known, asked_for));
  }
  return reasons;
}

}  // namespace waymark
