#include "core/camera/kalibr_sigmas.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "core/camera/rig_parameters.h"

namespace waymark {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr double kSecondsPerMicro = 1e-6;

/// A key of `sigma`.
struct SigmaKey {
  std::string_view name;
  CameraQuantity quantity;
  std::optional<double> StatedSigmas::*field;
  double unit;  ///< of the file in that of StatedSigmas
  double most;  ///< in the file's unit: more says nothing, or is in another unit
};

constexpr std::array kKeys{
    SigmaKey{"position_m", CameraQuantity::position, &StatedSigmas::position_m, 1, 10},
    SigmaKey{"rotation_deg", CameraQuantity::rotation, &StatedSigmas::rotation_rad, kRadPerDeg,
             180},
    SigmaKey{"focal", CameraQuantity::focal, &StatedSigmas::focal, 1, 1},
    SigmaKey{"principal_px", CameraQuantity::principal, &StatedSigmas::principal_px, 1, 1e4},
    SigmaKey{"k1", CameraQuantity::k1, &StatedSigmas::k1, 1, 10},
    SigmaKey{"edge_px", CameraQuantity::edge, &StatedSigmas::edge_px, 1, 10},
    SigmaKey{"stamp_us", CameraQuantity::stamp, &StatedSigmas::stamp_s, kSecondsPerMicro, 1e6},
    SigmaKey{"readout_us", CameraQuantity::readout, &StatedSigmas::readout_s, kSecondsPerMicro,
             1e6}};

/// Of a correlation matrix's Cholesky pivots: smaller is singular but for rounding.
constexpr double kSmallestPivot = 1e-12;
/// Sigmas beside the joint ones are written with fewer digits.
constexpr double kRounding = 0.01;

const SigmaKey& key_of(CameraQuantity quantity) {
  return *std::find_if(kKeys.begin(), kKeys.end(),
                       [&](const SigmaKey& key) { return key.quantity == quantity; });
}

/// Reads the sigmas of one camera.
class SigmaReader {
 public:
  SigmaReader(const YAML::Node& node, const std::string& file, RigCamera& camera)
      : node_(node), file_(file), camera_(camera) {}

  Expected<std::vector<double>> read() {
    if (auto read = read_sigma(); !read) return tl::make_unexpected(read.error());
    if (auto read = read_source(); !read) return tl::make_unexpected(read.error());
    return read_joint();
  }

 private:
  [[nodiscard]] tl::unexpected<Error> wrong(std::string_view key, const YAML::Node& at,
                                            std::string_view why) const {
    return fail(ErrorKind::bad_data, "{}: line {}: {}: {}: {}", file_, at.Mark().line + 1,
                camera_.name, key, why);
  }

  [[nodiscard]] Expected<double> number(const std::string& key, const YAML::Node& at) const {
    double value = 0;
    if (!at.IsScalar() || !YAML::convert<double>::decode(at, value)) {
      return wrong(key, at, "is no number");
    }
    if (!std::isfinite(value)) return wrong(key, at, "is not finite");
    return value;
  }

  [[nodiscard]] Status read_sigma() {
    const YAML::Node sigma = node_["sigma"];
    if (!sigma.IsDefined()) return {};
    if (!sigma.IsMap()) return wrong("sigma", sigma, "is no map such as {focal: 0.001, k1: 0.005}");
    std::set<std::string> seen;
    for (const auto& item : sigma) {
      const auto name = item.first.as<std::string>();
      if (!seen.insert(name).second)
        return wrong("sigma: " + name, item.first, "stands there twice");
      if (auto taken = take(name, item.first, item.second); !taken) return taken;
    }
    return {};
  }

  [[nodiscard]] Status take(const std::string& name, const YAML::Node& at,
                            const YAML::Node& stated) {
    const auto* const key = std::find_if(kKeys.begin(), kKeys.end(),
                                         [&](const SigmaKey& known) { return known.name == name; });
    if (key == kKeys.end()) {
      std::vector<std::string_view> names;
      for (const SigmaKey& known : kKeys) names.push_back(known.name);
      return wrong("sigma: " + name, at, fmt::format("is not one of {}", fmt::join(names, ", ")));
    }
    const auto value = number("sigma: " + name, stated);
    if (!value) return tl::make_unexpected(value.error());
    if (!(*value > 0 && *value <= key->most)) {
      return wrong("sigma: " + name, stated,
                   fmt::format("{:g} is not above 0 and at most {:g}", *value, key->most));
    }
    camera_.stated_sigmas.*(key->field) = key->unit * *value;
    return {};
  }

  [[nodiscard]] Status read_source() {
    const YAML::Node at = node_["sigma_source"];
    if (!at.IsDefined()) return {};
    camera_.sigma_source = sigma_source_from(at.IsScalar() ? at.Scalar() : "");
    if (camera_.sigma_source) return {};
    return wrong("sigma_source", at, "is not one of kalibr, opencv, hand, refined");
  }

  [[nodiscard]] Expected<std::vector<double>> read_joint() const {
    std::vector<double> triangle;
    const YAML::Node at = node_["sigma_joint"];
    if (!at.IsDefined()) return triangle;
    if (camera_.name != "cam0") return wrong("sigma_joint", at, "stands at cam0, for all cameras");
    if (!at.IsSequence() || at.size() == 0)
      return wrong("sigma_joint", at, "is no list of numbers");
    for (const auto& item : at) {
      const auto value = number("sigma_joint", item);
      if (!value) return tl::make_unexpected(value.error());
      triangle.push_back(*value);
    }
    return triangle;
  }

  const YAML::Node& node_;
  const std::string& file_;
  RigCamera& camera_;
};

/// What the file's units are in those of rig_parameters.
Eigen::VectorXd units_of(const std::vector<RigParameter>& parameters) {
  Eigen::VectorXd units(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < units.size(); ++i) {
    units[i] = key_of(parameters[static_cast<std::size_t>(i)].quantity).unit;
  }
  return units;
}

/// The symmetric matrix of a lower triangle, row by row.
Eigen::MatrixXd symmetric_of(const std::vector<double>& triangle, Eigen::Index size) {
  Eigen::MatrixXd matrix(size, size);
  std::size_t next = 0;
  for (Eigen::Index row = 0; row < size; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      matrix(row, column) = matrix(column, row) = triangle[next++];
    }
  }
  return matrix;
}

bool is_positive_definite(const Eigen::MatrixXd& covariance) {
  if (!(covariance.diagonal().array() > 0).all()) return false;
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * covariance * scale.asDiagonal());
  if (llt.info() != Eigen::Success) return false;
  return llt.matrixLLT().diagonal().cwiseAbs2().minCoeff() > kSmallestPivot;
}

/// Fails where a camera states a sigma of what is not among the rig's parameters.
Status check_that_rig_has(const std::vector<RigParameter>& parameters, const std::string& file,
                          const Rig& rig) {
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    for (const SigmaKey& key : kKeys) {
      const RigParameter first{c, key.quantity, 0};
      if (!(rig.cameras[c].stated_sigmas.*key.field) ||
          std::find(parameters.begin(), parameters.end(), first) != parameters.end()) {
        continue;
      }
      const char* why = key.quantity == CameraQuantity::k1 ? "its lens has no coefficient"
                        : key.quantity == CameraQuantity::readout
                            ? "a global shutter reads out at once"
                            : "the camera is the rig's frame, or its place is not stated";
      return fail(ErrorKind::bad_data, "{}: {}: sigma: {}: the model lacks it: {}", file,
                  rig.cameras[c].name, key.name, why);
    }
  }
  return {};
}

/// Fails where a stated sigma lies beyond all of its joint ones, per axis: they are another rig's.
Status check_agreement(const std::vector<RigParameter>& parameters, const std::string& file,
                       const Rig& rig) {
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    for (const SigmaKey& key : kKeys) {
      const auto& stated = rig.cameras[c].stated_sigmas.*key.field;
      if (!stated) continue;
      double least = std::numeric_limits<double>::infinity();
      double most = 0;
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (parameters[i].camera != c || parameters[i].quantity != key.quantity) continue;
        const auto at = static_cast<Eigen::Index>(i);
        const double sigma = std::sqrt((*rig.joint_sigmas)(at, at));
        least = std::min(least, sigma);
        most = std::max(most, sigma);
      }
      if (*stated >= (1 - kRounding) * least && *stated <= (1 + kRounding) * most) continue;
      return fail(ErrorKind::bad_data,
                  "{}: {}: sigma: {} is {:g}, sigma_joint says {:g}: it is of another rig", file,
                  rig.cameras[c].name, key.name, *stated / key.unit, most / key.unit);
    }
  }
  return {};
}

std::string format_triangle(const Eigen::MatrixXd& joint, const Eigen::VectorXd& units) {
  std::vector<std::string> numbers;
  for (Eigen::Index row = 0; row < joint.rows(); ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      numbers.push_back(fmt::format("{:.17g}", joint(row, column) / (units[row] * units[column])));
    }
  }
  return fmt::format("  sigma_joint: [{}]\n", fmt::join(numbers, ", "));
}

}  // namespace

Expected<std::vector<double>> read_kalibr_sigmas(const YAML::Node& node, const std::string& file,
                                                 RigCamera& camera) {
  return SigmaReader(node, file, camera).read();
}

Status take_joint_sigmas(const std::vector<double>& sigma_joint, const std::string& file,
                         Rig& rig) {
  const std::vector<RigParameter> parameters = rig_parameters(rig);
  if (auto fine = check_that_rig_has(parameters, file, rig); !fine) return fine;
  if (sigma_joint.empty()) return {};
  const std::size_t count = parameters.size();
  if (sigma_joint.size() != count * (count + 1) / 2) {
    return fail(ErrorKind::bad_data,
                "{}: cam0: sigma_joint: {} numbers instead of {}, the lower triangle of {} "
                "parameters: it is of another rig",
                file, sigma_joint.size(), count * (count + 1) / 2, count);
  }
  const Eigen::VectorXd units = units_of(parameters);
  const Eigen::MatrixXd joint = units.asDiagonal() *
                                symmetric_of(sigma_joint, static_cast<Eigen::Index>(count)) *
                                units.asDiagonal();
  if (!is_positive_definite(joint)) {
    return fail(ErrorKind::bad_data, "{}: cam0: sigma_joint: is not positive definite", file);
  }
  rig.joint_sigmas = joint;
  return check_agreement(parameters, file, rig);
}

std::string format_kalibr_sigmas(const Rig& rig, std::size_t camera) {
  const RigCamera& one = rig.cameras[camera];
  std::vector<std::string> stated;
  for (const SigmaKey& key : kKeys) {
    const auto& sigma = one.stated_sigmas.*key.field;
    if (sigma) stated.push_back(fmt::format("{}: {:.17g}", key.name, *sigma / key.unit));
  }
  std::string text;
  if (!stated.empty()) text += fmt::format("  sigma: {{{}}}\n", fmt::join(stated, ", "));
  if (one.sigma_source) text += fmt::format("  sigma_source: {}\n", to_string(*one.sigma_source));
  if (camera == 0 && rig.joint_sigmas) {
    text += format_triangle(*rig.joint_sigmas, units_of(rig_parameters(rig)));
  }
  return text;
}

}  // namespace waymark
