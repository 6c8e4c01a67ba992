#include "core/camera/kalibr_camera.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "core/camera/kalibr.h"
#include "core/camera/kalibr_sigmas.h"
#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

/// Largest element of |RᵀR − I| that is still a rotation written with few digits.
constexpr double kMaxRotationError = 1e-3;
/// Below this it is rounding, not worth a note.
constexpr double kRoundingError = 1e-8;

/// Largest element of |RᵀR − I|.
double rotation_error(const Eigen::Matrix3d& r) {
  return (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& r) {
  const SingularVectors svd = singular_vectors(r);
  return svd.u * svd.v.transpose();
}

/// Reads the keys of one camera. Every function fails with file, line, camera and key.
class CameraReader {
 public:
  CameraReader(const std::string& file, const std::string& camera, const YAML::Node& node,
               std::vector<std::string>& notes)
      : file_(file), camera_(camera), node_(node), notes_(notes) {}

  Expected<KalibrCamera> read() const {
    if (!node_.IsMap()) return wrong("", node_, "is no map of keys");
    if (const auto status = check_keys(); !status) return tl::make_unexpected(status.error());
    const auto parameters = read_parameters();
    if (!parameters) return tl::make_unexpected(parameters.error());
    const auto model = CameraModel::create(*parameters);
    if (!model) return wrong("", node_, model.error().message);

    KalibrCamera entry{RigCamera{camera_, *model, {}, {}, {}, {}, {}, {}}, {}, {}};
    if (const auto status = read_transform("T_cn_cnm1", entry.cam_from_previous); !status) {
      return tl::make_unexpected(status.error());
    }
    if (const auto status = read_transform("T_cam_imu", entry.cam_from_body); !status) {
      return tl::make_unexpected(status.error());
    }
    if (const auto status = read_extras(entry.camera); !status) {
      return tl::make_unexpected(status.error());
    }
    auto sigma_joint = read_kalibr_sigmas(node_, file_, entry.camera);
    if (!sigma_joint) return tl::make_unexpected(sigma_joint.error());
    entry.sigma_joint = *std::move(sigma_joint);
    return entry;
  }

 private:
  [[nodiscard]] std::string place(std::string_view key, const YAML::Node& at) const {
    const YAML::Mark mark = at.IsDefined() ? at.Mark() : node_.Mark();
    return fmt::format("{}: line {}: {}{}{}", file_, mark.line + 1, camera_,
                       key.empty() ? "" : ": ", key);
  }

  [[nodiscard]] tl::unexpected<Error> wrong(std::string_view key, const YAML::Node& at,
                                            std::string_view why,
                                            std::optional<Cause> cause = std::nullopt) const {
    return tl::make_unexpected(
        Error{ErrorKind::bad_data, fmt::format("{}: {}", place(key, at), why), cause});
  }

  [[nodiscard]] Status check_keys() const {
    static const std::set<std::string> kKnown{
        "camera_model", "intrinsics",  "distortion_model", "distortion_coeffs", "resolution",
        "T_cn_cnm1",    "T_cam_imu",   "rostopic",         "timeshift_cam_imu", "cam_overlaps",
        "serial",       "lens_id",     "readout_us",       "global_shutter",    "sigma",
        "sigma_source", "sigma_joint", "edge_bias_px",     "response"};
    std::set<std::string> seen;
    for (const auto& item : node_) {
      const auto key = item.first.as<std::string>();
      if (!seen.insert(key).second) return wrong(key, item.first, "stands there twice");
      if (kKnown.contains(key)) continue;
      if (key == "T_imu_cam" || key == "T_ic") {
        return wrong(key, item.first,
                     "is the other way round than is read: write its inverse as T_cam_imu",
                     Cause::format);
      }
      // A misspelt transform would silently turn a rig into single cameras.
      if (key.starts_with("T_")) {
        return wrong(key, item.first, "unknown transform; known are T_cn_cnm1 and T_cam_imu");
      }
      notes_.push_back(place(key, item.first) + ": unknown key, not used");
    }
    return {};
  }

  [[nodiscard]] Expected<double> read_number(std::string_view key, const YAML::Node& at) const {
    double value = 0;
    if (!at.IsScalar() || !YAML::convert<double>::decode(at, value)) {
      return wrong(key, at, "is no number");
    }
    if (!std::isfinite(value)) return wrong(key, at, "is not finite");
    return value;
  }

  /// `count` finite numbers.
  [[nodiscard]] Expected<std::vector<double>> read_numbers(std::string_view key,
                                                           const YAML::Node& at,
                                                           std::size_t count) const {
    if (!at.IsDefined()) return wrong(key, at, "is missing");
    if (!at.IsSequence() || at.size() != count) {
      return wrong(
          key, at,
          fmt::format("{} instead of a list of {} numbers",
                      at.IsSequence() ? fmt::format("a list of {}", at.size()) : "something else",
                      count));
    }
    std::vector<double> values;
    for (const auto& item : at) {
      const auto value = read_number(key, item);
      if (!value) return tl::make_unexpected(value.error());
      values.push_back(*value);
    }
    return values;
  }

  [[nodiscard]] Expected<std::string> read_text(std::string_view key) const {
    const YAML::Node at = node_[std::string(key)];
    if (!at.IsDefined()) return wrong(key, at, "is missing");
    if (!at.IsScalar()) return wrong(key, at, "is no text");
    return at.Scalar();
  }

  [[nodiscard]] Expected<int> read_size(std::string_view what, double value) const {
    constexpr double kMaxSize_px = 100'000;
    if (value < 1 || value > kMaxSize_px || value != std::floor(value)) {
      return wrong("resolution", node_["resolution"],
                   fmt::format("{} {} is no whole number of pixels", what, value));
    }
    return static_cast<int>(value);
  }

  [[nodiscard]] Expected<CameraParameters> read_parameters() const {
    const auto model = read_text("camera_model");
    if (!model) return tl::make_unexpected(model.error());
    if (*model != "pinhole") {
      return wrong("camera_model", node_["camera_model"],
                   fmt::format("'{}' is not supported; calibrate with pinhole", *model));
    }
    CameraParameters p;
    const auto distortion = read_distortion(p);
    if (!distortion) return tl::make_unexpected(distortion.error());
    const auto intrinsics = read_numbers("intrinsics", node_["intrinsics"], 4);
    if (!intrinsics) return tl::make_unexpected(intrinsics.error());
    p.fu_px = (*intrinsics)[0];
    p.fv_px = (*intrinsics)[1];
    p.pu_px = (*intrinsics)[2];
    p.pv_px = (*intrinsics)[3];
    const auto resolution = read_numbers("resolution", node_["resolution"], 2);
    if (!resolution) return tl::make_unexpected(resolution.error());
    const auto width = read_size("width", (*resolution)[0]);
    if (!width) return tl::make_unexpected(width.error());
    const auto height = read_size("height", (*resolution)[1]);
    if (!height) return tl::make_unexpected(height.error());
    p.width_px = *width;
    p.height_px = *height;
    if (const auto order = check_order(p); !order) return tl::make_unexpected(order.error());
    return p;
  }

  /// Fails where focal lengths and principal point have clearly changed places.
  [[nodiscard]] Status check_order(const CameraParameters& p) const {
    const auto off_centre = [](double at, double size) { return std::abs(at / size - 0.5); };
    constexpr double kRim = 0.45;  // of the size: nearly at the image's edge, or beyond
    constexpr double kMiddle = 0.15;
    const bool at_rim =
        off_centre(p.pu_px, p.width_px) > kRim || off_centre(p.pv_px, p.height_px) > kRim;
    const bool focal_is_middle =
        off_centre(p.fu_px, p.width_px) < kMiddle && off_centre(p.fv_px, p.height_px) < kMiddle;
    if (!at_rim || !focal_is_middle) return {};
    return wrong("intrinsics", node_["intrinsics"],
                 fmt::format("the principal point ({:.6g}, {:.6g}) lies at or beyond the rim of "
                             "{}×{}: are they written as cx cy fx fy? Write fu fv pu pv",
                             p.pu_px, p.pv_px, p.width_px, p.height_px),
                 Cause::intrinsics);
  }

  /// Distortion coefficients that stand for themselves, or with a fifth, k3, that is zero.
  [[nodiscard]] Expected<std::vector<double>> read_coefficients(const YAML::Node& at) const {
    constexpr std::size_t kCount = 4;
    if (!at.IsDefined() || !at.IsSequence() || at.size() <= kCount) {
      return read_numbers("distortion_coeffs", at, kCount);
    }
    auto all = read_numbers("distortion_coeffs", at, at.size());
    if (!all) return all;
    if (std::any_of(all->begin() + kCount, all->end(), [](double c) { return c != 0; })) {
      return wrong("distortion_coeffs", at,
                   fmt::format("a list of {} instead of a list of 4 numbers: k1 k2 p1 p2 are read; "
                               "k3 and beyond (OpenCV's order) are not zero: calibrate with 4",
                               all->size()),
                   Cause::format);
    }
    all->resize(kCount);
    return all;
  }

  [[nodiscard]] Status read_distortion(CameraParameters& p) const {
    const auto name = read_text("distortion_model");
    if (!name) return tl::make_unexpected(name.error());
    const auto known = {Distortion::none, Distortion::radtan, Distortion::equidistant};
    const auto* const found = std::find_if(known.begin(), known.end(),
                                           [&](Distortion d) { return to_string(d) == *name; });
    if (found == known.end()) {
      return wrong("distortion_model", node_["distortion_model"],
                   fmt::format("'{}' is not one of none, radtan, equidistant", *name));
    }
    p.distortion = *found;
    const YAML::Node at = node_["distortion_coeffs"];
    const bool empty = !at.IsDefined() || at.IsNull() || (at.IsSequence() && at.size() == 0);
    if (p.distortion == Distortion::none && empty) return {};
    const auto coefficients = read_coefficients(at);
    if (!coefficients) return tl::make_unexpected(coefficients.error());
    std::copy(coefficients->begin(), coefficients->end(), p.coefficients.begin());
    if (p.distortion == Distortion::none && p.coefficients != std::array<double, 4>{}) {
      return wrong("distortion_coeffs", at, "are not zero although distortion_model is none");
    }
    return {};
  }

  [[nodiscard]] Status read_transform(const std::string& key, std::optional<Rigid3>& into) const {
    const YAML::Node at = node_[key];
    if (!at.IsDefined()) return {};
    if (!at.IsSequence() || at.size() != 4) return wrong(key, at, "has not 4 rows of 4 numbers");
    Eigen::Matrix4d t;
    for (int row = 0; row < 4; ++row) {
      const auto values = read_numbers(key, at[row], 4);
      if (!values) return tl::make_unexpected(values.error());
      t.row(row) = Eigen::RowVector4d::Map(values->data());
    }
    if (!t.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-9)) {
      return wrong(key, at[3], "last row is not 0 0 0 1");
    }
    const Eigen::Matrix3d r = t.topLeftCorner<3, 3>();
    const double error = rotation_error(r);
    if (error > kMaxRotationError || r.determinant() < 0) {
      return wrong(key, at,
                   fmt::format("is no rotation: largest element of RᵀR − I {:.3g}, determinant "
                               "{:.3g}; copy all its digits",
                               error, r.determinant()));
    }
    if (error > kRoundingError) {
      notes_.push_back(
          fmt::format("{}: rotation is off by {:.2g} (largest element of RᵀR − I); the "
                      "nearest rotation is used",
                      place(key, at), error));
    }
    const Eigen::Vector3d translation = t.topRightCorner<3, 1>();
    if (translation.norm() > kMaxBaseline_m) {
      return wrong(
          key, at,
          fmt::format("translation of {:.3g} m: it must be in metres; is it in millimetres?",
                      translation.norm()),
          Cause::rig_unit);
    }
    into = Rigid3{Eigen::Quaterniond(nearest_rotation(r)).normalized(), translation};
    return {};
  }

  /// A number that may be absent.
  [[nodiscard]] Status read_range(const char* key, std::string_view unit, const Range& range,
                                  std::optional<double>& into) const {
    const YAML::Node at = node_[key];
    if (!at.IsDefined()) return {};
    const auto value = read_number(key, at);
    if (!value) return tl::make_unexpected(value.error());
    if (!range.contains(*value)) {
      return wrong(key, at,
                   fmt::format("is not within {:.0f} and {:.0f} {}", range.low, range.high, unit));
    }
    into = *value;
    return {};
  }

  [[nodiscard]] Status read_response(RigCamera& camera) const {
    const YAML::Node at = node_["response"];
    if (!at.IsDefined()) return {};
    const std::string name = at.IsScalar() ? at.Scalar() : "";
    if (name == "auto") return {};
    camera.response = sensor_response_from(name);
    if (camera.response) return {};
    return wrong("response", at, "is not one of auto, linear, srgb");
  }

  [[nodiscard]] Status read_extras(RigCamera& camera) const {
    for (const auto& [key, into] :
         {std::pair{"serial", &camera.serial}, {"lens_id", &camera.lens_id}}) {
      if (!node_[key].IsDefined()) continue;
      auto text = read_text(key);
      if (!text) return tl::make_unexpected(text.error());
      *into = *std::move(text);
    }
    if (const auto status =
            read_range("readout_us", "µs", RigCamera::kReadout_us, camera.readout_us);
        !status) {
      return status;
    }
    if (const auto status =
            read_range("edge_bias_px", "px", RigCamera::kEdgeBias_px, camera.edge_bias_px);
        !status) {
      return status;
    }
    if (const auto status = read_response(camera); !status) return status;
    if (const YAML::Node at = node_["global_shutter"]; at.IsDefined()) {
      bool value = false;
      if (!at.IsScalar() || !YAML::convert<bool>::decode(at, value)) {
        return wrong("global_shutter", at, "is neither true nor false");
      }
      camera.global_shutter = value;
    }
    if (const YAML::Node at = node_["timeshift_cam_imu"]; at.IsDefined()) {
      const auto value = read_number("timeshift_cam_imu", at);
      if (!value) return tl::make_unexpected(value.error());
      camera.timeshift_cam_imu_s = *value;
      notes_.push_back(fmt::format("{}: {} s, not used", place("timeshift_cam_imu", at), *value));
    }
    return {};
  }

  const std::string& file_;
  const std::string& camera_;
  const YAML::Node& node_;
  std::vector<std::string>& notes_;
};

}  // namespace

Expected<KalibrCamera> read_kalibr_camera(const YAML::Node& node, const std::string& camera,
                                          const std::string& file,
                                          std::vector<std::string>& notes) {
  return CameraReader(file, camera, node, notes).read();
}

}  // namespace waymark
