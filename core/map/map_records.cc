#include "core/map/map_records.h"

#include <algorithm>
#include <span>
#include <waymark/map_capture_t.hpp>
#include <waymark/map_header_t.hpp>
#include <waymark/map_marker_t.hpp>
#include <waymark/map_submap_t.hpp>
#include <waymark/map_world_t.hpp>

#include "core/base/check.h"

namespace waymark {
namespace {

/// From this container version on a map_world_t follows every map_submap_t, and NaN stands for a
/// covariance that nobody knows.
constexpr std::uint32_t kWorldRecords = 2;

/// Every record is of fixed size, so that any record's size is its type's.
template <typename Record>
std::size_t encoded_size() {
  return static_cast<std::size_t>(Record().getEncodedSize());
}

template <typename Record>
void append(std::string& bytes, const Record& record) {
  const std::size_t begin = bytes.size();
  bytes.resize(begin + encoded_size<Record>());
  const int size = record.encode(bytes.data() + begin, 0, record.getEncodedSize());
  WAYMARK_CHECK(size == record.getEncodedSize());
}

/// Takes records off the front of a payload.
class RecordReader {
 public:
  explicit RecordReader(std::string_view payload) : rest_(payload) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }

  /// Whether `count` records can follow: what a file says of its own length is not trusted.
  template <typename Record>
  [[nodiscard]] bool has_room_for(std::int32_t count) const {
    return count >= 0 && static_cast<std::size_t>(count) <= rest_.size() / encoded_size<Record>();
  }

  template <typename Record>
  [[nodiscard]] Expected<Record> take() {
    const std::size_t size = encoded_size<Record>();
    Record record;
    if (rest_.size() < size ||
        record.decode(rest_.data(), 0, static_cast<int>(size)) != static_cast<int>(size)) {
      return fail(ErrorKind::bad_data, "no {} record where one must be", Record::getTypeName());
    }
    rest_.remove_prefix(size);
    return record;
  }

 private:
  std::string_view rest_;
};

/// Text in a field of fixed length, the rest zeros.
void put_text(std::string_view text, std::span<std::uint8_t> field) {
  WAYMARK_CHECK(text.size() <= field.size());
  std::fill(field.begin(), field.end(), std::uint8_t{0});
  std::copy(text.begin(), text.end(), field.begin());
}

std::string text_in(std::span<const std::uint8_t> field) {
  return {field.begin(), std::find(field.begin(), field.end(), std::uint8_t{0})};
}

map_marker_t record_of(const MapMarker& marker) {
  map_marker_t record{};
  record.family = static_cast<std::int32_t>(marker.id.family);
  record.number = marker.id.number;
  record.stated_size_m = marker.stated_size_m;
  record.size_m = marker.size_m;
  Eigen::Vector3d::Map(record.position_in_world_m) = marker.world_from_marker.translation;
  Eigen::Vector4d::Map(record.world_from_marker_xyzw) = marker.world_from_marker.rotation.coeffs();
  // Symmetric, so that row-major and column-major are one; the lower half is what is stored.
  Matrix6d::Map(record.covariance) =
      marker.covariance_known() ? Matrix6d(marker.covariance.selfadjointView<Eigen::Lower>())
                                : unknown_covariance();
  record.observations = static_cast<std::int32_t>(marker.observations);
  record.rejected = static_cast<std::int32_t>(marker.rejected);
  record.rms_px = marker.rms_px;
  record.verified = static_cast<std::int8_t>(marker.verified ? 1 : 0);
  return record;
}

Expected<MapMarker> marker_of(const map_marker_t& record) {
  const auto family = family_from_number(record.family);
  if (!family) {
    return fail(ErrorKind::bad_data, "marker {} of unknown family {}", record.number,
                record.family);
  }
  if (record.observations < 0 || record.rejected < 0 ||
      (record.verified != 0 && record.verified != 1)) {
    return fail(ErrorKind::bad_data, "marker {}: observations or verified are out of range",
                record.number);
  }
  MapMarker marker;
  marker.id = {*family, record.number};
  marker.stated_size_m = record.stated_size_m;
  marker.size_m = record.size_m;
  marker.world_from_marker.translation = Eigen::Vector3d::Map(record.position_in_world_m);
  marker.world_from_marker.rotation.coeffs() = Eigen::Vector4d::Map(record.world_from_marker_xyzw);
  marker.covariance = Matrix6d::Map(record.covariance);
  marker.observations = static_cast<std::uint32_t>(record.observations);
  marker.rejected = static_cast<std::uint32_t>(record.rejected);
  marker.rms_px = record.rms_px;
  marker.verified = record.verified == 1;
  return marker;
}

/// Whether z is up; a file of version 1 knows it of the facility frame alone.
Expected<bool> take_z_is_up(RecordReader& reader, FrameKind frame, std::uint32_t version) {
  if (version < kWorldRecords) return frame == FrameKind::facility;
  const auto record = reader.take<map_world_t>();
  if (!record) return tl::make_unexpected(record.error());
  if (record->z_is_up != 0 && record->z_is_up != 1) {
    return fail(ErrorKind::bad_data, "z_is_up is out of range");
  }
  return record->z_is_up == 1;
}

Expected<SubMap> take_submap(RecordReader& reader, std::uint32_t version) {
  const auto record = reader.take<map_submap_t>();
  if (!record) return tl::make_unexpected(record.error());
  if (record->frame < 0 || record->frame > static_cast<int>(FrameKind::facility)) {
    return fail(ErrorKind::bad_data, "unknown kind of frame {}", record->frame);
  }
  if (record->frame_sets < 0 || !reader.has_room_for<map_marker_t>(record->markers)) {
    return fail(ErrorKind::bad_data, "{} markers and {} frame sets don't fit the file",
                record->markers, record->frame_sets);
  }
  SubMap submap;
  submap.frame = static_cast<FrameKind>(record->frame);
  submap.frame_sets = static_cast<std::uint32_t>(record->frame_sets);
  submap.rms_px = record->rms_px;
  submap.rms_all_px = record->rms_all_px;
  const auto z_is_up = take_z_is_up(reader, submap.frame, version);
  if (!z_is_up) return tl::make_unexpected(z_is_up.error());
  submap.z_is_up = *z_is_up;
  submap.markers.reserve(static_cast<std::size_t>(record->markers));
  for (std::int32_t i = 0; i < record->markers; ++i) {
    const auto marker_record = reader.take<map_marker_t>();
    if (!marker_record) return tl::make_unexpected(marker_record.error());
    auto marker = marker_of(*marker_record);
    if (!marker) return tl::make_unexpected(marker.error());
    if (version < kWorldRecords && marker->covariance.isZero(0)) {
      marker->covariance = unknown_covariance();
    }
    submap.markers.push_back(*std::move(marker));
  }
  return submap;
}

}  // namespace

std::string encode_records(const MarkerMap& map) {
  map_header_t header{};
  header.captures = static_cast<std::int32_t>(map.capture_fingerprints.size());
  header.submaps = static_cast<std::int32_t>(map.submaps.size());
  put_text(map.builder_version, header.builder_version);
  put_text(map.rig_fingerprint, header.rig_fingerprint);
  std::string bytes;
  append(bytes, header);
  for (const std::string& fingerprint : map.capture_fingerprints) {
    map_capture_t capture{};
    put_text(fingerprint, capture.fingerprint);
    append(bytes, capture);
  }
  for (const SubMap& submap : map.submaps) {
    map_submap_t record{};
    record.frame = static_cast<std::int32_t>(submap.frame);
    record.markers = static_cast<std::int32_t>(submap.markers.size());
    record.frame_sets = static_cast<std::int32_t>(submap.frame_sets);
    record.rms_px = submap.rms_px;
    record.rms_all_px = submap.rms_all_px;
    append(bytes, record);
    map_world_t world{};
    world.z_is_up = static_cast<std::int8_t>(submap.z_is_up ? 1 : 0);
    append(bytes, world);
    for (const MapMarker& marker : submap.markers) append(bytes, record_of(marker));
  }
  return bytes;
}

Expected<MarkerMap> decode_records(std::string_view payload, std::uint32_t version) {
  RecordReader reader(payload);
  const auto header = reader.take<map_header_t>();
  if (!header) return tl::make_unexpected(header.error());
  if (!reader.has_room_for<map_capture_t>(header->captures)) {
    return fail(ErrorKind::bad_data, "{} captures don't fit the file", header->captures);
  }
  MarkerMap map;
  map.builder_version = text_in(header->builder_version);
  map.rig_fingerprint = text_in(header->rig_fingerprint);
  for (std::int32_t i = 0; i < header->captures; ++i) {
    const auto capture = reader.take<map_capture_t>();
    if (!capture) return tl::make_unexpected(capture.error());
    map.capture_fingerprints.push_back(text_in(capture->fingerprint));
  }
  if (!reader.has_room_for<map_submap_t>(header->submaps)) {
    return fail(ErrorKind::bad_data, "{} sub-maps don't fit the file", header->submaps);
  }
  for (std::int32_t i = 0; i < header->submaps; ++i) {
    auto submap = take_submap(reader, version);
    if (!submap) return tl::make_unexpected(submap.error());
    map.submaps.push_back(*std::move(submap));
  }
  if (!reader.at_end()) return fail(ErrorKind::bad_data, "bytes left over after the last marker");
  return map;
}

}  // namespace waymark
