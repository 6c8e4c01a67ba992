#include "core/map/map_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/atomic_file.h"
#include "core/base/json_fields.h"
#include "core/map/json_value.h"
#include "core/map/map_check.h"
#include "core/map/map_file.h"

namespace waymark {
namespace {

using nlohmann::ordered_json;

constexpr int kSchema = 1;
/// A quaternion typed with two decimals is off by less; one of another kind by more.
constexpr double kMaxQuaternionError = 0.01;
constexpr std::array<std::string_view, 3> kFrameNames = {"arbitrary", "scaled", "facility"};
constexpr double kLowest = std::numeric_limits<double>::lowest();
constexpr double kHighest = std::numeric_limits<double>::max();
constexpr std::int64_t kMaxCount = std::numeric_limits<std::int32_t>::max();
/// What somebody measured is never known exactly.
constexpr double kSmallestSigma = 1e-9;
constexpr double kLargestSigma_m = 10;
constexpr double kLargestSigma_deg = 180;

using RowMajorModes = Eigen::Matrix<float, 6, kMapModes, Eigen::RowMajor>;

ordered_json covariance_json(const Matrix6d& covariance) {
  if (!covariance.allFinite()) return nullptr;
  return std::vector<double>(covariance.data(), covariance.data() + covariance.size());
}

ordered_json marker_json(const MapMarker& marker, bool with_family) {
  const Eigen::Vector3d& t = marker.world_from_marker.translation;
  const Eigen::Quaterniond& q = marker.world_from_marker.rotation;
  ordered_json json{{"id", json_of(marker.id, with_family)},
                    {"family", name_of(marker.id.family)},
                    {"size_m", marker.size_m},
                    {"stated_size_m", marker.stated_size_m},
                    {"position_m", {t.x(), t.y(), t.z()}},
                    {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}},
                    {"covariance", covariance_json(marker.covariance)},
                    {"covariance_metric", covariance_json(marker.metric())}};
  if (marker.considered()) {
    const RowMajorModes modes = marker.modes;
    json["modes"] = std::vector<double>(modes.data(), modes.data() + modes.size());
  }
  json["observations"] = marker.observations;
  json["rejected"] = marker.rejected;
  json["rms_px"] = marker.rms_px;
  json["verified"] = marker.verified;
  return json;
}

std::string text_of(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

/// The lines of what a sub-map considers; none where that is nothing.
std::string format_parameters(const SubMap& submap) {
  if (submap.parameters.empty()) return {};
  std::string text = "      \"parameters\": [\n";
  for (std::size_t i = 0; i < submap.parameters.size(); ++i) {
    const MapParameter& one = submap.parameters[i];
    const ordered_json json{
        {"name", one.name},
        {"serial", one.serial},
        {"cross", std::vector<double>(one.cross.data(), one.cross.data() + kMapModes)}};
    text +=
        fmt::format("        {}{}\n", text_of(json), i + 1 < submap.parameters.size() ? "," : "");
  }
  std::vector<double> triangle;
  for (Eigen::Index row = 0; row < submap.parameter_covariance.rows(); ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      triangle.push_back(submap.parameter_covariance(row, column));
    }
  }
  return text + fmt::format("      ],\n      \"parameter_covariance\": {},\n",
                            text_of(ordered_json(triangle)));
}

std::string format_submap(const SubMap& submap, bool with_family) {
  std::string text = fmt::format(
      "    {{\n"
      "      \"frame\": \"{}\",\n"
      "      \"z_is_up\": {},\n"
      "      \"frame_sets\": {},\n"
      "      \"rms_px\": {},\n"
      "      \"rms_all_px\": {},\n"
      "{}"
      "      \"markers\": [\n",
      name_of(submap.frame), submap.z_is_up, submap.frame_sets, text_of(submap.rms_px),
      text_of(submap.rms_all_px), format_parameters(submap));
  for (std::size_t i = 0; i < submap.markers.size(); ++i) {
    text += fmt::format("        {}{}\n", text_of(marker_json(submap.markers[i], with_family)),
                        i + 1 < submap.markers.size() ? "," : "");
  }
  return text + "      ]\n    }";
}

std::uint32_t read_count(JsonFields& fields, std::string_view key) {
  return static_cast<std::uint32_t>(fields.integer(key, 0, kMaxCount, 0));
}

/// As "covariance" has it, or "sigma_m" and "sigma_deg", or unknown.
Matrix6d read_covariance(JsonFields& fields) {
  constexpr double kRadiansPerDegree = 0.017453292519943295;
  fields.value("covariance");  // may be null, where nobody knows it
  const bool by_sigmas = fields.has("sigma_m") || fields.has("sigma_deg");
  if (by_sigmas && fields.contains("covariance")) {
    fields.reject("has both a covariance and sigmas; leave one out");
  }
  if (by_sigmas) {
    const double sigma_m = fields.number("sigma_m", kSmallestSigma, kLargestSigma_m);
    const double sigma_rad =
        kRadiansPerDegree * fields.number("sigma_deg", kSmallestSigma, kLargestSigma_deg);
    Matrix6d covariance = Matrix6d::Zero();
    covariance.diagonal().head<3>().setConstant(sigma_m * sigma_m);
    covariance.diagonal().tail<3>().setConstant(sigma_rad * sigma_rad);
    return covariance;
  }
  if (!fields.has("covariance")) return unknown_covariance();
  return Matrix6d::Map(fields.numbers("covariance", 36).data());
}

/// What the marker considers; nothing where its metric covariance is its covariance.
void read_considered(JsonFields& fields, MapMarker& marker) {
  if (fields.contains("modes")) {
    marker.modes = RowMajorModes(
        Eigen::Matrix<double, 6, kMapModes, Eigen::RowMajor>::Map(
            fields.numbers("modes", static_cast<std::size_t>(marker.modes.size())).data())
            .cast<float>());
  }
  fields.value("covariance_metric");  // may be null, where nobody knows it
  if (!fields.has("covariance_metric")) return;
  const Matrix6d metric = Matrix6d::Map(fields.numbers("covariance_metric", 36).data());
  if (!marker.modes.isZero(0) || metric != marker.covariance) marker.covariance_metric = metric;
}

void read_parameters(JsonFields& fields, SubMap& submap) {
  if (!fields.contains("parameters")) return;
  fields.each("parameters", [&](JsonFields& one) {
    submap.parameters.push_back(
        {one.text("name"), one.text("serial", ""),
         Eigen::Matrix<double, 1, kMapModes>::Map(one.numbers("cross", kMapModes).data())});
  });
  const auto n = static_cast<Eigen::Index>(submap.parameters.size());
  const std::vector<double> triangle =
      fields.numbers("parameter_covariance", static_cast<std::size_t>(n * (n + 1) / 2));
  submap.parameter_covariance.resize(n, n);
  std::size_t next = 0;
  for (Eigen::Index row = 0; row < n; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      submap.parameter_covariance(row, column) = submap.parameter_covariance(column, row) =
          triangle[next++];
    }
  }
}

MapMarker read_marker(JsonFields& fields) {
  MapMarker marker;
  marker.id = read_marker_id(fields);
  marker.size_m = fields.number("size_m");
  marker.stated_size_m = fields.number("stated_size_m", kLowest, kHighest, marker.size_m);
  Rigid3& pose = marker.world_from_marker;
  pose.translation = Eigen::Vector3d::Map(fields.numbers("position_m", 3).data());
  Eigen::Vector4d& quaternion = pose.rotation.coeffs();
  quaternion = Eigen::Vector4d::Map(fields.numbers("quaternion_xyzw", 4).data());
  marker.covariance = read_covariance(fields);
  read_considered(fields, marker);
  marker.observations = read_count(fields, "observations");
  marker.rejected = read_count(fields, "rejected");
  marker.rms_px = fields.number("rms_px", kLowest, kHighest, 0);
  marker.verified = fields.boolean("verified", true);
  const double norm = quaternion.norm();
  if (!(std::abs(norm - 1) <= kMaxQuaternionError)) {
    fields.reject(fmt::format("quaternion of norm {:.6g} instead of 1", norm));
  }
  // One that is exact stays as it is, bit for bit.
  if (std::abs(norm - 1) > 1e-12) quaternion /= norm;
  return marker;
}

SubMap read_submap(JsonFields& fields) {
  SubMap submap;
  submap.frame = static_cast<FrameKind>(
      fields.choice("frame", {kFrameNames[0], kFrameNames[1], kFrameNames[2]}, 0));
  submap.z_is_up = fields.boolean("z_is_up", submap.frame == FrameKind::facility);
  submap.frame_sets = read_count(fields, "frame_sets");
  submap.rms_px = fields.number("rms_px", kLowest, kHighest, 0);
  submap.rms_all_px = fields.number("rms_all_px", kLowest, kHighest, 0);
  read_parameters(fields, submap);
  submap.markers.reserve(fields.count("markers"));
  fields.each("markers",
              [&](JsonFields& marker) { submap.markers.push_back(read_marker(marker)); });
  std::sort(submap.markers.begin(), submap.markers.end(),
            [](const MapMarker& a, const MapMarker& b) { return a.id < b.id; });
  return submap;
}

MarkerMap read_document(JsonFields& fields) {
  const std::int64_t schema = fields.integer("schema", 0, kMaxCount);
  if (schema != kSchema) {
    fields.reject(fmt::format("schema {} is not {}, the one this program reads{}", schema, kSchema,
                              schema > kSchema ? "; update Waymark" : ""));
  }
  MarkerMap map;
  map.builder_version = fields.text("builder_version", "");
  map.rig_fingerprint = fields.text("rig_fingerprint", "");
  map.capture_fingerprints = fields.texts("capture_fingerprints");
  std::sort(map.capture_fingerprints.begin(), map.capture_fingerprints.end());
  fields.allow("content_hash");
  fields.each("submaps", [&](JsonFields& submap) { map.submaps.push_back(read_submap(submap)); });
  std::stable_sort(map.submaps.begin(), map.submaps.end(), [](const SubMap& a, const SubMap& b) {
    return a.markers.size() > b.markers.size();
  });
  return map;
}

}  // namespace

std::string_view name_of(FrameKind frame) {
  return kFrameNames.at(static_cast<std::size_t>(frame));
}

std::string format_map_json(const MarkerMap& map) {
  std::string text = fmt::format(
      "{{\n"
      "  \"schema\": {},\n"
      "  \"builder_version\": {},\n"
      "  \"content_hash\": \"{}\",\n"
      "  \"rig_fingerprint\": {},\n"
      "  \"capture_fingerprints\": {},\n"
      "  \"submaps\": [\n",
      kSchema, text_of(map.builder_version), content_hash(map), text_of(map.rig_fingerprint),
      text_of(map.capture_fingerprints));
  for (std::size_t i = 0; i < map.submaps.size(); ++i) {
    text += format_submap(map.submaps[i], map.several_families()) +
            (i + 1 < map.submaps.size() ? ",\n" : "\n");
  }
  return text + "  ]\n}\n";
}

Expected<MarkerMap> parse_map_json(std::string_view text, const std::string& name) {
  const auto document = parse_json(text, name, kMaxMapJsonBytes);
  if (!document) return tl::make_unexpected(document.error());
  JsonFields fields(*document, name);
  auto map = read_document(fields);
  if (const auto status = fields.finish(); !status) return tl::make_unexpected(status.error());
  if (const auto status = check_map(map); !status) {
    return fail(ErrorKind::bad_data, "{}: {}", name, status.error().message);
  }
  return map;
}

Expected<MarkerMap> read_map_json(const std::filesystem::path& path) {
  const auto text = read_file(path, kMaxMapJsonBytes);
  if (!text) return tl::make_unexpected(text.error());
  return parse_map_json(*text, path.string());
}

}  // namespace waymark
