#include "core/camera/kalibr_camera.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "core/camera/kalibr.h"
#include "core/camera/kalibr_lens.h"
#include "core/camera/kalibr_sigmas.h"
#include "core/camera/lens_kind.h"
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

/// Reads the keys of one camera.
class CameraReader : private KalibrNode {
 public:
  CameraReader(const std::string& file, const std::string& camera, const YAML::Node& node,
               std::vector<std::string>& notes)
      : KalibrNode(file, camera, node), notes_(notes) {}

  Expected<KalibrCamera> read() const {
    if (!node().IsMap()) return wrong("", node(), "is no map of keys");
    if (const auto status = check_keys(); !status) return tl::make_unexpected(status.error());
    const auto parameters = read_kalibr_lens(*this);
    if (!parameters) return tl::make_unexpected(parameters.error());
    const auto model = CameraModel::create(*parameters);
    if (!model) return wrong("", node(), model.error().message);
    note_valid_radius(*model);

    KalibrCamera entry{RigCamera{this->camera(), *model, {}, {}, {}, {}, {}, {}}, {}, {}};
    if (const auto status = read_transform("T_cn_cnm1", entry.cam_from_previous); !status) {
      return tl::make_unexpected(status.error());
    }
    if (const auto status = read_transform("T_cam_imu", entry.cam_from_body); !status) {
      return tl::make_unexpected(status.error());
    }
    if (const auto status = read_extras(entry.camera); !status) {
      return tl::make_unexpected(status.error());
    }
    auto sigma_joint = read_kalibr_sigmas(node(), file(), entry.camera);
    if (!sigma_joint) return tl::make_unexpected(sigma_joint.error());
    entry.sigma_joint = *std::move(sigma_joint);
    return entry;
  }

 private:
  /// Where a calibration ends inside the image; not of a fisheye's round image, which leaves its
  /// corners black.
  void note_valid_radius(const CameraModel& model) const {
    const CameraParameters& p = model.parameters();
    if (!p.valid_radius_px && bends_by_angle(p.distortion)) return;
    const double right = p.width_px - 1;
    const double bottom = p.height_px - 1;
    const std::array<Eigen::Vector2d, 4> corners{
        {{0, 0}, {right, 0}, {right, bottom}, {0, bottom}}};
    if (model.covers_all(corners)) return;
    notes_.push_back(fmt::format(
        "{}: farther than {:.0f} px from the principal point the calibration says nothing; markers "
        "there are left out",
        place("", node()), model.valid_radius_px()));
  }

  [[nodiscard]] Status check_keys() const {
    static const std::set<std::string> kKnown{
        "camera_model", "intrinsics",  "distortion_model", "distortion_coeffs", "resolution",
        "T_cn_cnm1",    "T_cam_imu",   "rostopic",         "timeshift_cam_imu", "cam_overlaps",
        "serial",       "lens_id",     "readout_us",       "global_shutter",    "sigma",
        "sigma_source", "sigma_joint", "edge_bias_px",     "response",          "valid_radius_px"};
    std::set<std::string> seen;
    for (const auto& item : node()) {
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

  [[nodiscard]] Status read_transform(const std::string& key, std::optional<Rigid3>& into) const {
    const YAML::Node at = node()[key];
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
    const YAML::Node at = node()[key];
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
    const YAML::Node at = node()["response"];
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
      if (!node()[key].IsDefined()) continue;
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
    if (const YAML::Node at = node()["global_shutter"]; at.IsDefined()) {
      bool value = false;
      if (!at.IsScalar() || !YAML::convert<bool>::decode(at, value)) {
        return wrong("global_shutter", at, "is neither true nor false");
      }
      camera.global_shutter = value;
    }
    if (const YAML::Node at = node()["timeshift_cam_imu"]; at.IsDefined()) {
      const auto value = read_number("timeshift_cam_imu", at);
      if (!value) return tl::make_unexpected(value.error());
      camera.timeshift_cam_imu_s = *value;
      notes_.push_back(fmt::format("{}: {} s, not used", place("timeshift_cam_imu", at), *value));
    }
    return {};
  }

  std::vector<std::string>& notes_;
};

}  // namespace

Expected<KalibrCamera> read_kalibr_camera(const YAML::Node& node, const std::string& camera,
                                          const std::string& file,
                                          std::vector<std::string>& notes) {
  return CameraReader(file, camera, node, notes).read();
}

}  // namespace waymark
