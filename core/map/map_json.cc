#include "core/map/map_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <span>

#include "core/map/json_value.h"
#include "core/map/map_check.h"
#include "core/map/map_file.h"

namespace waymark {
namespace {

using nlohmann::ordered_json;

constexpr int kSchema = 1;
/// A quaternion typed with two decimals is off by less; one of another kind by more.
constexpr double kMaxQuaternionError = 0.01;
constexpr std::array kFrameNames = {"arbitrary", "scaled", "facility"};

ordered_json marker_json(const MapMarker& marker, bool with_family) {
  const Eigen::Vector3d& t = marker.world_from_marker.translation;
  const Eigen::Quaterniond& q = marker.world_from_marker.rotation;
  const double* const covariance = marker.covariance.data();
  const ordered_json known = std::vector<double>(covariance, covariance + 36);
  return {{"id", json_of(marker.id, with_family)},
          {"family", name_of(marker.id.family)},
          {"size_m", marker.size_m},
          {"stated_size_m", marker.stated_size_m},
          {"position_m", {t.x(), t.y(), t.z()}},
          {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"covariance", marker.covariance_known() ? known : ordered_json(nullptr)},
          {"observations", marker.observations},
          {"rejected", marker.rejected},
          {"rms_px", marker.rms_px},
          {"verified", marker.verified}};
}

std::string text_of(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string format_submap(const SubMap& submap, bool with_family) {
  std::string text = fmt::format(
      "    {{\n"
      "      \"frame\": \"{}\",\n"
      "      \"z_is_up\": {},\n"
      "      \"frame_sets\": {},\n"
      "      \"rms_px\": {},\n"
      "      \"rms_all_px\": {},\n"
      "      \"markers\": [\n",
      name_of(submap.frame), submap.z_is_up, submap.frame_sets, text_of(submap.rms_px),
      text_of(submap.rms_all_px));
  for (std::size_t i = 0; i < submap.markers.size(); ++i) {
    text += fmt::format("        {}{}\n", text_of(marker_json(submap.markers[i], with_family)),
                        i + 1 < submap.markers.size() ? "," : "");
  }
  return text + "      ]\n    }";
}

/// A value inside the document and where it stands ("submaps[0].markers[3].size_m").
class Place {
 public:
  Place(const ordered_json& value, std::string path) : value_(&value), path_(std::move(path)) {}

  [[nodiscard]] tl::unexpected<Error> wrong(std::string_view why) const {
    return fail(ErrorKind::bad_data, "{}: {}", path_.empty() ? "top level" : path_, why);
  }

  [[nodiscard]] Status check_keys(std::initializer_list<std::string_view> known) const {
    if (!value_->is_object()) return wrong("is no object");
    for (const auto& [key, value] : value_->items()) {
      if (std::find(known.begin(), known.end(), key) == known.end()) {
        return wrong(
            fmt::format("unknown key \"{}\"; known here: {}", key, fmt::join(known, ", ")));
      }
    }
    return {};
  }

  [[nodiscard]] bool has(const char* key) const { return value_->contains(key); }
  [[nodiscard]] bool is_null(const char* key) const {
    return has(key) && value_->at(key).is_null();
  }

  [[nodiscard]] Expected<Place> at(const char* key) const {
    if (!has(key)) return wrong(fmt::format("\"{}\" is missing", key));
    return Place(value_->at(key), path_.empty() ? key : path_ + "." + key);
  }

  /// The elements of a list.
  [[nodiscard]] Expected<std::vector<Place>> elements() const {
    if (!value_->is_array()) return wrong("is no list");
    std::vector<Place> places;
    for (std::size_t i = 0; i < value_->size(); ++i) {
      places.emplace_back((*value_)[i], fmt::format("{}[{}]", path_, i));
    }
    return places;
  }

  [[nodiscard]] Status read(double& into) const {
    if (!value_->is_number()) return wrong("is no number");
    into = value_->get<double>();
    return {};
  }

  [[nodiscard]] Status read(std::uint32_t& into) const {
    if (!value_->is_number_unsigned() || value_->get<std::uint64_t>() > 0x7FFF'FFFF) {
      return wrong("is no count");
    }
    into = value_->get<std::uint32_t>();
    return {};
  }

  [[nodiscard]] Status read(bool& into) const {
    if (!value_->is_boolean()) return wrong("is neither true nor false");
    into = value_->get<bool>();
    return {};
  }

  [[nodiscard]] Status read(std::string& into) const {
    if (!value_->is_string()) return wrong("is no text");
    into = value_->get<std::string>();
    return {};
  }

  [[nodiscard]] Status read(std::span<double> into) const {
    if (!value_->is_array() || value_->size() != into.size()) {
      return wrong(fmt::format("is no list of {} numbers", into.size()));
    }
    for (std::size_t i = 0; i < into.size(); ++i) {
      const Place element((*value_)[i], fmt::format("{}[{}]", path_, i));
      if (auto status = element.read(into[i]); !status) return status;
    }
    return {};
  }

  /// Reads what stands under `key` into `into`.
  template <typename Value>
  [[nodiscard]] Status require(const char* key, Value&& into) const {
    const auto place = at(key);
    if (!place) return tl::make_unexpected(place.error());
    return place->read(into);
  }

  /// The same where the key is there, else leaves `into` as it is.
  template <typename Value>
  [[nodiscard]] Status allow(const char* key, Value&& into) const {
    return has(key) ? require(key, into) : Status{};
  }

  /// A marker's id: a number, or text such as "12" or "tag36h11:12".
  [[nodiscard]] Expected<MarkerId> read_id(Family family) const {
    const std::string text = value_->is_string()           ? value_->get<std::string>()
                             : value_->is_number_integer() ? value_->dump()
                                                           : "";
    const auto id = parse_marker_id(text, family);
    if (!id) return wrong(id.error().message);
    if (id->family != family) return wrong("the family is not the one under \"family\"");
    return *id;
  }

 private:
  const ordered_json* value_;
  std::string path_;
};

/// The first failure among steps done one after another.
Status all_of(std::initializer_list<Status> steps) {
  const auto* const failed =
      std::find_if(steps.begin(), steps.end(), [](const Status& step) { return !step; });
  return failed == steps.end() ? Status{} : *failed;
}

Expected<MarkerId> read_marker_id(const Place& place) {
  std::string family_name;
  if (const auto status = place.require("family", family_name); !status) {
    return tl::make_unexpected(status.error());
  }
  const auto family = family_from_name(family_name);
  if (!family) return place.wrong(fmt::format("unknown family \"{}\"", family_name));
  const auto id = place.at("id");
  if (!id) return tl::make_unexpected(id.error());
  return id->read_id(*family);
}

/// As "covariance" has it, or "sigma_m" and "sigma_deg", or unknown.
Expected<Matrix6d> read_covariance(const Place& place) {
  constexpr double kRadiansPerDegree = 0.017453292519943295;
  const bool by_sigmas = place.has("sigma_m") || place.has("sigma_deg");
  Matrix6d covariance = unknown_covariance();
  if (!by_sigmas && (!place.has("covariance") || place.is_null("covariance"))) return covariance;
  if (!by_sigmas) {
    const Status read = place.require("covariance", std::span(covariance.data(), 36));
    if (!read) return tl::make_unexpected(read.error());
    return covariance;
  }
  if (place.has("covariance"))
    return place.wrong("has both a covariance and sigmas; leave one out");
  double sigma_m = 0;
  double sigma_deg = 0;
  const Status read =
      all_of({place.require("sigma_m", sigma_m), place.require("sigma_deg", sigma_deg)});
  if (!read) return tl::make_unexpected(read.error());
  if (!(sigma_m > 0 && sigma_m <= 10) || !(sigma_deg > 0 && sigma_deg <= 180)) {
    return place.wrong("sigma_m is not within 0 and 10 m, or sigma_deg not within 0 and 180°");
  }
  const double sigma_rad = sigma_deg * kRadiansPerDegree;
  covariance.setZero();
  covariance.diagonal().head<3>().setConstant(sigma_m * sigma_m);
  covariance.diagonal().tail<3>().setConstant(sigma_rad * sigma_rad);
  return covariance;
}

Expected<MapMarker> read_marker(const Place& place) {
  const Status known = place.check_keys({"id", "family", "size_m", "stated_size_m", "position_m",
                                         "quaternion_xyzw", "covariance", "sigma_m", "sigma_deg",
                                         "observations", "rejected", "rms_px", "verified"});
  if (!known) return tl::make_unexpected(known.error());
  const auto id = read_marker_id(place);
  if (!id) return tl::make_unexpected(id.error());
  MapMarker marker;
  marker.id = *id;
  marker.verified = true;
  Eigen::Vector3d& position = marker.world_from_marker.translation;
  Eigen::Vector4d& quaternion = marker.world_from_marker.rotation.coeffs();
  const Status read = all_of(
      {place.require("size_m", marker.size_m),
       place.require("position_m", std::span(position.data(), 3)),
       place.require("quaternion_xyzw", std::span(quaternion.data(), 4)),
       place.allow("observations", marker.observations), place.allow("rejected", marker.rejected),
       place.allow("rms_px", marker.rms_px), place.allow("verified", marker.verified)});
  if (!read) return tl::make_unexpected(read.error());
  const auto covariance = read_covariance(place);
  if (!covariance) return tl::make_unexpected(covariance.error());
  marker.covariance = *covariance;
  marker.stated_size_m = marker.size_m;
  const Status stated = place.allow("stated_size_m", marker.stated_size_m);
  if (!stated) return tl::make_unexpected(stated.error());
  const double norm = quaternion.norm();
  if (!(std::abs(norm - 1) <= kMaxQuaternionError)) {
    return place.wrong(fmt::format("quaternion of norm {:.6g} instead of 1", norm));
  }
  // One that is exact stays as it is, bit for bit.
  if (std::abs(norm - 1) > 1e-12) quaternion /= norm;
  return marker;
}

Expected<SubMap> read_submap(const Place& place) {
  const Status known =
      place.check_keys({"frame", "z_is_up", "frame_sets", "rms_px", "rms_all_px", "markers"});
  if (!known) return tl::make_unexpected(known.error());
  SubMap submap;
  std::string frame = kFrameNames[0];
  const Status read =
      all_of({place.allow("frame", frame), place.allow("frame_sets", submap.frame_sets),
              place.allow("rms_px", submap.rms_px), place.allow("rms_all_px", submap.rms_all_px)});
  if (!read) return tl::make_unexpected(read.error());
  const auto* const name = std::find(kFrameNames.begin(), kFrameNames.end(), frame);
  if (name == kFrameNames.end()) {
    return place.wrong(
        fmt::format("frame \"{}\" is not one of {}", frame, fmt::join(kFrameNames, ", ")));
  }
  submap.frame = static_cast<FrameKind>(name - kFrameNames.begin());
  submap.z_is_up = submap.frame == FrameKind::facility;
  if (const auto up = place.allow("z_is_up", submap.z_is_up); !up) {
    return tl::make_unexpected(up.error());
  }
  const auto markers = place.at("markers");
  if (!markers) return tl::make_unexpected(markers.error());
  const auto elements = markers->elements();
  if (!elements) return tl::make_unexpected(elements.error());
  for (const Place& element : *elements) {
    auto marker = read_marker(element);
    if (!marker) return tl::make_unexpected(marker.error());
    submap.markers.push_back(*std::move(marker));
  }
  std::sort(submap.markers.begin(), submap.markers.end(),
            [](const MapMarker& a, const MapMarker& b) { return a.id < b.id; });
  return submap;
}

Expected<MarkerMap> read_document(const ordered_json& document) {
  const Place place(document, "");
  const Status known = place.check_keys({"schema", "builder_version", "content_hash",
                                         "rig_fingerprint", "capture_fingerprints", "submaps"});
  if (!known) return tl::make_unexpected(known.error());
  std::uint32_t schema = 0;
  if (const auto status = place.require("schema", schema); !status) {
    return tl::make_unexpected(status.error());
  }
  if (schema != kSchema) {
    return place.wrong(fmt::format("schema {} is not {}, the one this program reads{}", schema,
                                   kSchema, schema > kSchema ? "; update Waymark" : ""));
  }
  MarkerMap map;
  const Status read = all_of({place.allow("builder_version", map.builder_version),
                              place.allow("rig_fingerprint", map.rig_fingerprint)});
  if (!read) return tl::make_unexpected(read.error());
  if (place.has("capture_fingerprints")) {
    const auto captures = place.at("capture_fingerprints")->elements();
    if (!captures) return tl::make_unexpected(captures.error());
    for (const Place& capture : *captures) {
      const auto status = capture.read(map.capture_fingerprints.emplace_back());
      if (!status) return tl::make_unexpected(status.error());
    }
    std::sort(map.capture_fingerprints.begin(), map.capture_fingerprints.end());
  }
  const auto list = place.at("submaps");
  if (!list) return tl::make_unexpected(list.error());
  const auto submaps = list->elements();
  if (!submaps) return tl::make_unexpected(submaps.error());
  for (const Place& element : *submaps) {
    auto submap = read_submap(element);
    if (!submap) return tl::make_unexpected(submap.error());
    map.submaps.push_back(*std::move(submap));
  }
  std::stable_sort(map.submaps.begin(), map.submaps.end(), [](const SubMap& a, const SubMap& b) {
    return a.markers.size() > b.markers.size();
  });
  if (const auto status = check_map(map); !status) return tl::make_unexpected(status.error());
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
  try {
    auto map = read_document(ordered_json::parse(text));
    if (map) return map;
    return fail(ErrorKind::bad_data, "{}: {}", name, map.error().message);
  } catch (const ordered_json::exception& bad) {
    return fail(ErrorKind::bad_data, "{}: not valid JSON: {}", name, bad.what());
  }
}

}  // namespace waymark
