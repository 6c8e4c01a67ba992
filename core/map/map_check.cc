#include "core/map/map_check.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

/// Nobody prints larger markers; a larger number is one in mm.
constexpr double kMaxSize_m = 100.0;
/// Further from each other than any building's markers, and far from where a double loses µm.
constexpr double kMaxPosition_m = 1e6;
/// No image is wider.
constexpr double kMaxRms_px = 1e6;
constexpr double kMaxQuaternionError = 1e-6;
/// Of a covariance's largest element: rounding of what was computed, or written and read as text;
/// of one that a file holds in floats; of what its modes leave, floats in the square.
constexpr double kCovarianceRounding = 1e-9;
constexpr double kFloatRounding = 1e-6;
constexpr double kModeRounding = 1e-5;
constexpr std::uint32_t kMaxCount = std::numeric_limits<std::int32_t>::max();

bool is_size(double size_m) { return size_m > 0 && size_m <= kMaxSize_m; }

bool is_rms(double rms_px) { return rms_px >= 0 && rms_px <= kMaxRms_px; }

bool is_fingerprint(std::string_view text) {
  return text.size() == kFingerprintLength &&
         text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// What is wrong with the covariance, or nothing.
std::string_view covariance_fault(const Matrix6d& covariance, double share) {
  if (covariance.array().isNaN().all()) return {};
  if (!(covariance.array().abs() <= kMaxPosition_m * kMaxPosition_m).all()) {
    return "covariance is not finite or beyond (1000 km)²";
  }
  const double rounding = share * covariance.cwiseAbs().maxCoeff();
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > rounding) {
    return "covariance is not symmetric";
  }
  if (!(symmetric_eigenvalues<6>(covariance).minCoeff() >= -rounding)) {
    return "covariance is not positive semidefinite";
  }
  return {};
}

/// What is wrong with what the marker considers, or nothing.
std::string_view considered_fault(const MapMarker& marker) {
  if (const auto fault = covariance_fault(marker.covariance_metric, kCovarianceRounding);
      !fault.empty()) {
    return fault;
  }
  if (!marker.modes.allFinite()) return "modes are not finite";
  if (!marker.considered()) {
    return marker.modes.isZero(0) ? "" : "modes without a metric covariance";
  }
  const Eigen::Matrix<double, 6, kMapModes> modes = marker.modes.cast<double>();
  const Matrix6d own = marker.covariance_metric - modes * modes.transpose();
  const double rounding = kModeRounding * marker.covariance_metric.cwiseAbs().maxCoeff();
  if (!(symmetric_eigenvalues<6>(own).minCoeff() >= -rounding)) {
    return "modes are more than its metric covariance";
  }
  return {};
}

/// What is wrong with the marker, or nothing.
std::string_view marker_fault(const MapMarker& marker, bool in_floats) {
  if (marker.id.number < 0 || marker.id.number >= traits(marker.id.family).id_count) {
    return "number lies outside the family";
  }
  if (!is_size(marker.size_m) || !is_size(marker.stated_size_m)) {
    return "size is not within 0 and 100 m";
  }
  const Rigid3& pose = marker.world_from_marker;
  if (!(pose.translation.array().abs() <= kMaxPosition_m).all()) {
    return "position is not finite or beyond 1000 km";
  }
  if (!(std::abs(pose.rotation.norm() - 1) <= kMaxQuaternionError)) {
    return "quaternion is not of unit norm";
  }
  if (marker.observations > kMaxCount || marker.rejected > kMaxCount) {
    return "number of observations is out of range";
  }
  if (!is_rms(marker.rms_px)) return "RMS is not within 0 and 1e6 px";
  const double rounding = in_floats ? kFloatRounding : kCovarianceRounding;
  if (const auto fault = covariance_fault(marker.covariance, rounding); !fault.empty()) {
    return fault;
  }
  return considered_fault(marker);
}

bool is_text(std::string_view text, std::size_t most) {
  return text.size() <= most && text.find('\0') == std::string_view::npos;
}

/// Symmetric and, by its correlations, positive semidefinite.
bool is_covariance(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return true;
  if (!matrix.allFinite() || matrix != matrix.transpose()) return false;
  if (!(matrix.diagonal().array() >= 0).all()) return false;
  const Eigen::VectorXd sigmas = matrix.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale =
      (sigmas.array() > 0).select(sigmas.cwiseInverse(), Eigen::VectorXd::Zero(sigmas.size()));
  Eigen::MatrixXd correlations = scale.asDiagonal() * matrix * scale.asDiagonal();
  correlations.diagonal().array() += kFloatRounding;
  correlations +=
      (sigmas.array() > 0)
          .select(Eigen::VectorXd::Zero(sigmas.size()), Eigen::VectorXd::Ones(sigmas.size()))
          .asDiagonal();
  return Eigen::LLT<Eigen::MatrixXd>(correlations).info() == Eigen::Success;
}

Status check_parameters(const SubMap& submap, std::size_t number) {
  const auto count = static_cast<Eigen::Index>(submap.parameters.size());
  for (const MapParameter& parameter : submap.parameters) {
    if (parameter.name.empty() || !is_text(parameter.name, kMaxParameterText) ||
        !is_text(parameter.serial, kMaxSerialText) || !parameter.cross.allFinite()) {
      return fail(ErrorKind::bad_data, "sub-map {}: a parameter's name, serial or numbers", number);
    }
  }
  const Eigen::MatrixXd& covariance = submap.parameter_covariance;
  if (covariance.rows() != count || covariance.cols() != count || !is_covariance(covariance)) {
    return fail(ErrorKind::bad_data, "sub-map {}: the parameters' covariance is none", number);
  }
  // Modes have variance 1: nothing has more in common with one than its own sigma.
  for (Eigen::Index i = 0; i < count; ++i) {
    const MapParameter& parameter = submap.parameters[static_cast<std::size_t>(i)];
    const double most = (1 + kFloatRounding) * std::sqrt(covariance(i, i));
    if (parameter.cross.cwiseAbs().maxCoeff() > most) {
      return fail(ErrorKind::bad_data, "sub-map {}: {} has more in common with modes than it has",
                  number, parameter.name);
    }
  }
  return {};
}

Status check_submap(const SubMap& submap, std::size_t number, bool in_floats,
                    std::set<MarkerId>& seen) {
  if (submap.markers.empty()) return fail(ErrorKind::bad_data, "sub-map {}: no markers", number);
  if (submap.frame > FrameKind::facility) {
    return fail(ErrorKind::bad_data, "sub-map {}: unknown kind of frame {}", number,
                static_cast<int>(submap.frame));
  }
  if (submap.frame == FrameKind::facility && !submap.z_is_up) {
    return fail(ErrorKind::bad_data, "sub-map {}: a facility frame whose z is not up", number);
  }
  if (submap.frame_sets > kMaxCount || !is_rms(submap.rms_px) || !is_rms(submap.rms_all_px)) {
    return fail(ErrorKind::bad_data, "sub-map {}: frame sets or RMS are out of range", number);
  }
  if (auto fine = check_parameters(submap, number); !fine) return fine;
  const MapMarker* previous = nullptr;
  for (const MapMarker& marker : submap.markers) {
    const auto wrong = [&](std::string_view why) {
      return fail(ErrorKind::bad_data, "sub-map {}: marker {}: {}", number,
                  format_marker_id(marker.id, true), why);
    };
    if (const std::string_view fault = marker_fault(marker, in_floats); !fault.empty()) {
      return wrong(fault);
    }
    if (!seen.insert(marker.id).second) return wrong("stands there twice");
    if (previous != nullptr && marker.id < previous->id) return wrong("ids don't rise");
    previous = &marker;
  }
  return {};
}

}  // namespace

Status check_map(const MarkerMap& map) {
  if (map.builder_version.size() > kMaxBuilderVersion) {
    return fail(ErrorKind::bad_data, "builder version is longer than {} bytes", kMaxBuilderVersion);
  }
  if (!map.rig_fingerprint.empty() && !is_fingerprint(map.rig_fingerprint)) {
    return fail(ErrorKind::bad_data, "rig fingerprint is not 16 hexadecimal digits");
  }
  const auto& captures = map.capture_fingerprints;
  if (!std::all_of(captures.begin(), captures.end(), is_fingerprint) ||
      !std::is_sorted(captures.begin(), captures.end())) {
    return fail(ErrorKind::bad_data,
                "capture fingerprints are not 16 hexadecimal digits each, in order");
  }
  if (map.submaps.empty()) return fail(ErrorKind::bad_data, "no markers");
  std::set<MarkerId> seen;
  const bool in_floats = map.considered();
  for (std::size_t i = 0; i < map.submaps.size(); ++i) {
    if (auto status = check_submap(map.submaps[i], i, in_floats, seen); !status) return status;
    if (i > 0 && map.submaps[i].markers.size() > map.submaps[i - 1].markers.size()) {
      return fail(ErrorKind::bad_data, "sub-map {}: has more markers than the one before", i);
    }
  }
  return {};
}

}  // namespace waymark
