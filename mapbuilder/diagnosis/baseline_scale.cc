#include "mapbuilder/diagnosis/baseline_scale.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "mapbuilder/diagnosis/length_unit.h"

namespace waymark {

std::optional<BaselineScale> baseline_scale(const Rig& stated, const Rig& fitted,
                                            const Eigen::MatrixXd& covariance, double least_gain) {
  constexpr double kCalibration_m = 0.001;
  constexpr double kCalibration_rad = 0.00087;
  constexpr double kMostLeft = 0.25;
  const auto others = static_cast<Eigen::Index>(stated.cameras.size()) - 1;
  if (others < 1 || covariance.rows() != 6 * (others + 1)) return std::nullopt;
  const Eigen::Vector3d& first = stated.cameras.front().rig_from_cam.translation;
  Eigen::VectorXd off(6 * others);
  Eigen::VectorXd baseline = Eigen::VectorXd::Zero(6 * others);
  Eigen::MatrixXd spread = covariance.bottomRightCorner(6 * others, 6 * others);
  for (Eigen::Index k = 0; k < others; ++k) {
    const Rigid3& was = stated.cameras[static_cast<std::size_t>(k) + 1].rig_from_cam;
    const Rigid3& is = fitted.cameras[static_cast<std::size_t>(k) + 1].rig_from_cam;
    off.segment<6>(6 * k) = is.minus(was);
    baseline.segment<3>(6 * k) = was.translation - first;
    spread.diagonal().segment<3>(6 * k).array() += kCalibration_m * kCalibration_m;
    spread.diagonal().segment<3>(6 * k + 3).array() += kCalibration_rad * kCalibration_rad;
  }
  const Eigen::LDLT<Eigen::MatrixXd> factor(spread);
  if (!factor.isPositive()) return std::nullopt;
  const Eigen::VectorXd weighted = factor.solve(baseline);
  const double information = weighted.dot(baseline);
  if (!(information > 0)) return std::nullopt;
  const double change = weighted.dot(off) / information;
  const double all = off.dot(factor.solve(off));
  const double gain = change * change * information;
  if (!(gain > least_gain) || all - gain > kMostLeft * all) return std::nullopt;
  return BaselineScale{1.0 + change, 1.0 / std::sqrt(information)};
}

Rig with_baselines(Rig rig, double factor) {
  const Eigen::Vector3d from = rig.cameras.front().rig_from_cam.translation;
  for (RigCamera& camera : rig.cameras) {
    Eigen::Vector3d& at = camera.rig_from_cam.translation;
    at = from + factor * (at - from);
  }
  return rig;
}

std::string sizes_against_baselines(const BaselineScale& scale) {
  if (const auto unit = unit_of(scale.factor)) {
    return fmt::format(
        "stated sizes are {:.0f} times too large against the rig's baselines: sizes "
        "in {}, or baselines too small by so much",
        scale.factor, unit->name);
  }
  if (const auto unit = unit_of(1 / scale.factor)) {
    return fmt::format(
        "the rig's baselines are {:.0f} times too large against stated sizes: "
        "baselines in {}, or sizes too small by so much",
        1 / scale.factor, unit->name);
  }
  return fmt::format(
      "stated sizes are {:.1f} ± {:.1f} % too {} against the rig's baselines, or the baselines "
      "too {}",
      100.0 * std::abs(scale.factor - 1.0), std::max(0.1, 100.0 * scale.sigma),
      scale.factor < 1 ? "small" : "large", scale.factor < 1 ? "large" : "small");
}

Finding finding_of(const BaselineScale& scale, const Rig& rig) {
  constexpr double kLeaves = 0.05;
  Finding finding;
  finding.severity = std::abs(scale.factor - 1.0) > kLeaves ? Severity::error : Severity::warning;
  finding.cause = Cause::size_scale;
  for (std::size_t k = 1; k < rig.cameras.size(); ++k) {
    finding.cameras.push_back(rig.cameras[k].name);
  }
  finding.subject = fmt::format("{}", fmt::join(finding.cameras, ", "));
  finding.text = sizes_against_baselines(scale) + ".";
  finding.remedy = kMeasureSizes;
  finding.figures = {{"sizes", 100.0 * (scale.factor - 1.0), "%", 100.0 * scale.sigma}};
  return finding;
}

}  // namespace waymark
