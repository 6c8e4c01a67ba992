#include "core/estimate/calibration_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "core/base/check.h"
#include "core/camera/rig_fingerprint.h"
#include "core/estimate/consider_parameters.h"
#include "core/marker/marker_catalog.h"

namespace waymark {
namespace {

/// Nothing is known better than this (usual sigmas, squared): exact calibrations stay invertible.
constexpr double kLeastVariance = 1e-10;

/// What a careful calibration is known to: the units of all numbers.
CalibrationVector usual_sigmas() {
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  CalibrationVector v;
  v << Eigen::Vector3d::Constant(1e-3), Eigen::Vector3d::Constant(0.05 * kRadPerDeg), 1e-3, 0.5,
      0.5, 5e-3, 0.02, 1e-3, 1e-3;
  return v;
}

/// Where a number of a camera stands among its thirteen.
Eigen::Index place_of(const RigParameter& parameter) {
  constexpr std::array<Eigen::Index, 8> kFirst{0,          3,     kFocal, kPrincipal,
                                               kFirstLens, kEdge, kStamp, kReadout};
  return kFirst.at(static_cast<std::size_t>(parameter.quantity)) + parameter.axis;
}

double stated_size_m(const MapMarker& marker) {
  return marker.stated_size_m > 0 ? marker.stated_size_m : marker.size_m;
}

std::vector<double> sizes_of(const SubMap& map) {
  std::set<double> sizes;
  for (const MapMarker& marker : map.markers) sizes.insert(stated_size_m(marker));
  return {sizes.begin(), sizes.end()};
}

std::vector<StatedSize> with_usual_sigmas(const std::vector<double>& sizes_m) {
  std::vector<StatedSize> stated;
  for (const double size_m : sizes_m) {
    stated.push_back({size_m, default_size_sigma_m(size_m) / size_m});
  }
  return stated;
}

/// Where the map considered a parameter of this rig.
std::optional<Eigen::Index> find(const SubMap& map, const ConsiderParameter& parameter,
                                 const Rig& rig) {
  const std::string name = name_of(parameter, std::span(&rig, 1));
  const auto found = std::find_if(map.parameters.begin(), map.parameters.end(),
                                  [&](const MapParameter& p) { return p.name == name; });
  if (found == map.parameters.end()) return std::nullopt;
  return found - map.parameters.begin();
}

/// Whether the map's variance of an error says that something told it of more than the rig knows.
bool knows_better(const SubMap& map, Eigen::Index in_map, double variance) {
  constexpr double kSurer = 0.4;
  return map.parameter_covariance(in_map, in_map) < kSurer * kSurer * variance;
}

/// One number, and where it stands.
struct Number {
  Eigen::Index at = 0;
  double unit = 1;
  std::optional<Eigen::Index> in_map;  ///< where its error is the map's own
};

}  // namespace

const CalibrationVector& CalibrationPrior::units() {
  static const CalibrationVector kUnits = usual_sigmas();
  return kUnits;
}

CalibrationPrior::CalibrationPrior(const Rig& rig, const SigmaCircumstances& circumstances,
                                   const SubMap& map, bool same_calibration)
    : cameras_(rig.cameras.size()), sizes_m_(sizes_of(map)) {
  const bool shares = std::any_of(map.markers.begin(), map.markers.end(),
                                  [](const MapMarker& marker) { return !marker.modes.isZero(0); });
  modes_ = shares ? kMapModes : 0;
  const ConsiderParameters own =
      consider_parameters(std::span(&rig, 1), with_usual_sigmas(sizes_m_), circumstances);
  std::vector<Number> numbers;
  std::size_t size = 0;
  for (const ConsiderParameter& one : own.all) {
    Number& number = numbers.emplace_back();
    if (one.is_size()) {
      number = {at_size(size++), kSizeUnit, find(map, one, rig)};
    } else {
      const Eigen::Index place = place_of(one.of_rig);
      number = {first_of(one.of_rig.camera) + place, units()[place], std::nullopt};
      if (same_calibration) number.in_map = find(map, one, rig);
      const auto i = static_cast<Eigen::Index>(numbers.size()) - 1;
      if (one.of_rig.quantity == CameraQuantity::edge && number.in_map &&
          knows_better(map, *number.in_map, own.covariance(i, i))) {
        number.in_map.reset();
      }
    }
  }
  const Eigen::Index count = at_size(sizes_m_.size());
  covariance_.setZero(count + modes_, count + modes_);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Number& a = numbers[i];
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const Number& b = numbers[k];
      if (a.in_map.has_value() != b.in_map.has_value()) continue;
      const double both =
          a.in_map ? map.parameter_covariance(*a.in_map, *b.in_map)
                   : own.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      covariance_(a.at, b.at) = both / (a.unit * b.unit);
    }
    if (!a.in_map || modes_ == 0) continue;
    const auto& cross = map.parameters[static_cast<std::size_t>(*a.in_map)].cross;
    covariance_.block<1, kMapModes>(a.at, count) = cross / a.unit;
    covariance_.block<kMapModes, 1>(count, a.at) = cross.transpose() / a.unit;
  }
  covariance_.diagonal().tail(modes_).setOnes();
  if (modes_ > 0) {
    // Calibration tells modes of what was built with it, but for what rounding leaves below zero.
    const Eigen::MatrixXd root = square_root_of(covariance_);
    covariance_ = root * root.transpose();
  }
  covariance_.diagonal().array() += kLeastVariance;
  mean_.setZero(covariance_.rows());
}

std::size_t CalibrationPrior::size_of(const MapMarker& marker) const {
  const auto found = std::lower_bound(sizes_m_.begin(), sizes_m_.end(), stated_size_m(marker));
  return static_cast<std::size_t>(found - sizes_m_.begin());
}

void CalibrationPrior::learn(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
  WAYMARK_CHECK(mean.size() == size() && covariance.rows() == size());
  mean_ = mean;
  covariance_ = covariance;
}

void CalibrationPrior::widen(std::size_t camera, const CalibrationVector& sigmas) {
  covariance_.diagonal().segment<kCalibrationNumbers>(first_of(camera)).array() +=
      (sigmas.array() / units().array()).square();
}

CalibrationVector CalibrationPrior::variances_of(std::size_t camera) const {
  return covariance_.diagonal()
      .segment<kCalibrationNumbers>(first_of(camera))
      .cwiseProduct(units().cwiseAbs2());
}

double CalibrationPrior::size_variance(std::size_t size) const {
  return covariance_(at_size(size), at_size(size)) * kSizeUnit * kSizeUnit;
}

bool is_calibration_of(const SubMap& map, const std::string& rig_fingerprint, const Rig& rig) {
  if (rig_fingerprint != fingerprint(rig)) return false;
  const std::vector<RigParameter> parameters = rig_parameters(rig);
  return std::all_of(parameters.begin(), parameters.end(), [&](const RigParameter& one) {
    const auto at = find(map, {0, one, 0}, rig);
    return at && map.parameters[static_cast<std::size_t>(*at)].serial ==
                     rig.cameras[one.camera].serial.substr(0, kMaxSerialText);
  });
}

bool knows_edges_better(const SubMap& map, const Rig& rig, std::size_t camera) {
  const RigParameter edge{camera, CameraQuantity::edge, 0};
  const auto in_map = find(map, {0, edge, 0}, rig);
  if (!in_map) return false;
  const std::vector<RigParameter> parameters = rig_parameters(rig);
  const auto i = std::find(parameters.begin(), parameters.end(), edge) - parameters.begin();
  return knows_better(map, *in_map, rig_covariance(rig)(i, i));
}

void state_exact_sizes(SubMap& map) {
  constexpr double kExact = 1e-9;
  map.parameters.clear();
  for (const double size_m : sizes_of(map)) {
    MapParameter& parameter = map.parameters.emplace_back();
    parameter.name = name_of({0, {}, size_m}, {});
  }
  const auto count = static_cast<Eigen::Index>(map.parameters.size());
  map.parameter_covariance = kExact * kExact * Eigen::MatrixXd::Identity(count, count);
}

}  // namespace waymark
