#include "core/map/map_records.h"

#include <algorithm>
#include <limits>
#include <span>
#include <waymark/map_capture_t.hpp>
#include <waymark/map_considered_marker_t.hpp>
#include <waymark/map_header_t.hpp>
#include <waymark/map_marker_t.hpp>
#include <waymark/map_parameter_covariance_t.hpp>
#include <waymark/map_parameter_t.hpp>
#include <waymark/map_parameters_t.hpp>
#include <waymark/map_submap_t.hpp>
#include <waymark/map_world_t.hpp>

#include "core/base/check.h"

namespace waymark {
namespace {

/// From this container version on a map_world_t follows every map_submap_t, and NaN stands for a
/// covariance that nobody knows.
constexpr std::uint32_t kWorldRecords = 2;
/// From this one on, what a map considers stands in it.
constexpr std::uint32_t kConsideredRecords = 3;
/// No rig has more numbers: 200 cameras of 13.
constexpr std::int32_t kMaxParameters = 4096;

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

/// The lower triangle, row by row.
template <typename Number>
void put_triangle(const Matrix6d& symmetric, bool known, Number* triangle) {
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column) {
      *triangle++ = known ? static_cast<Number>(symmetric(row, column))
                          : std::numeric_limits<Number>::quiet_NaN();
    }
  }
}

template <typename Number>
Matrix6d symmetric_of(const Number* triangle) {
  Matrix6d symmetric;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column) {
      symmetric(row, column) = symmetric(column, row) = static_cast<double>(*triangle++);
    }
  }
  return symmetric;
}

using RowMajorModes = Eigen::Matrix<float, 6, kMapModes, Eigen::RowMajor>;

void put_covariances(const MapMarker& marker, map_marker_t& record) {
  // Symmetric, so that row-major and column-major are one; the lower half is what is stored.
  Matrix6d::Map(record.covariance) =
      marker.covariance_known() ? Matrix6d(marker.covariance.selfadjointView<Eigen::Lower>())
                                : unknown_covariance();
}

void put_covariances(const MapMarker& marker, map_considered_marker_t& record) {
  put_triangle(marker.covariance_metric, marker.considered(), record.metric_covariance);
  put_triangle(marker.covariance, marker.covariance_known(), record.covariance);
  RowMajorModes::Map(record.modes) = marker.modes;
}

void take_covariances(const map_marker_t& record, MapMarker& marker) {
  marker.covariance = Matrix6d::Map(record.covariance);
}

void take_covariances(const map_considered_marker_t& record, MapMarker& marker) {
  marker.covariance_metric = symmetric_of(record.metric_covariance);
  marker.covariance = symmetric_of(record.covariance);
  marker.modes = RowMajorModes::Map(record.modes);
}

template <typename Record>
Record record_of(const MapMarker& marker) {
  Record record{};
  record.family = static_cast<std::int32_t>(marker.id.family);
  record.number = marker.id.number;
  record.stated_size_m = marker.stated_size_m;
  record.size_m = marker.size_m;
  Eigen::Vector3d::Map(record.position_in_world_m) = marker.world_from_marker.translation;
  Eigen::Vector4d::Map(record.world_from_marker_xyzw) = marker.world_from_marker.rotation.coeffs();
  put_covariances(marker, record);
  record.observations = static_cast<std::int32_t>(marker.observations);
  record.rejected = static_cast<std::int32_t>(marker.rejected);
  record.rms_px = marker.rms_px;
  record.verified = static_cast<std::int8_t>(marker.verified ? 1 : 0);
  return record;
}

template <typename Record>
Expected<MapMarker> marker_of(const Record& record) {
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
  take_covariances(record, marker);
  marker.observations = static_cast<std::uint32_t>(record.observations);
  marker.rejected = static_cast<std::uint32_t>(record.rejected);
  marker.rms_px = record.rms_px;
  marker.verified = record.verified == 1;
  return marker;
}

void append_parameters(const SubMap& submap, std::string& bytes) {
  map_parameters_t count{};
  count.parameters = static_cast<std::int32_t>(submap.parameters.size());
  append(bytes, count);
  for (const MapParameter& parameter : submap.parameters) {
    map_parameter_t record{};
    put_text(parameter.name, record.name);
    put_text(parameter.serial, record.serial);
    Eigen::Matrix<double, 1, kMapModes>::Map(record.cross) = parameter.cross;
    append(bytes, record);
  }
  for (Eigen::Index row = 0; row < submap.parameter_covariance.rows(); ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      map_parameter_covariance_t record{};
      record.covariance = submap.parameter_covariance(row, column);
      append(bytes, record);
    }
  }
}

Status take_parameters(RecordReader& reader, SubMap& submap) {
  const auto count = reader.take<map_parameters_t>();
  if (!count) return tl::make_unexpected(count.error());
  const std::int32_t n = count->parameters;
  if (n > kMaxParameters || !reader.has_room_for<map_parameter_t>(n)) {
    return fail(ErrorKind::bad_data, "{} parameters don't fit the file", n);
  }
  for (std::int32_t i = 0; i < n; ++i) {
    const auto record = reader.take<map_parameter_t>();
    if (!record) return tl::make_unexpected(record.error());
    submap.parameters.push_back({text_in(record->name), text_in(record->serial),
                                 Eigen::Matrix<double, 1, kMapModes>::Map(record->cross)});
  }
  if (!reader.has_room_for<map_parameter_covariance_t>(n * (n + 1) / 2)) {
    return fail(ErrorKind::bad_data, "the covariance of {} parameters does not fit the file", n);
  }
  submap.parameter_covariance.resize(n, n);
  for (std::int32_t row = 0; row < n; ++row) {
    for (std::int32_t column = 0; column <= row; ++column) {
      const auto record = reader.take<map_parameter_covariance_t>();
      if (!record) return tl::make_unexpected(record.error());
      submap.parameter_covariance(row, column) = record->covariance;
      submap.parameter_covariance(column, row) = record->covariance;
    }
  }
  return {};
}

template <typename Record>
Status take_markers(RecordReader& reader, std::int32_t count, SubMap& submap) {
  if (!reader.has_room_for<Record>(count)) {
    return fail(ErrorKind::bad_data, "{} markers don't fit the file", count);
  }
  submap.markers.reserve(static_cast<std::size_t>(count));
  for (std::int32_t i = 0; i < count; ++i) {
    const auto record = reader.take<Record>();
    if (!record) return tl::make_unexpected(record.error());
    auto marker = marker_of(*record);
    if (!marker) return tl::make_unexpected(marker.error());
    submap.markers.push_back(*std::move(marker));
  }
  return {};
}

/// What nobody knew was written as zero by version 1.
void make_zeros_unknown(SubMap& submap) {
  for (MapMarker& marker : submap.markers) {
    if (marker.covariance.isZero(0)) marker.covariance = unknown_covariance();
  }
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
  if (record->frame_sets < 0) {
    return fail(ErrorKind::bad_data, "{} frame sets don't fit the file", record->frame_sets);
  }
  SubMap submap;
  submap.frame = static_cast<FrameKind>(record->frame);
  submap.frame_sets = static_cast<std::uint32_t>(record->frame_sets);
  submap.rms_px = record->rms_px;
  submap.rms_all_px = record->rms_all_px;
  const auto z_is_up = take_z_is_up(reader, submap.frame, version);
  if (!z_is_up) return tl::make_unexpected(z_is_up.error());
  submap.z_is_up = *z_is_up;
  if (version >= kConsideredRecords) {
    if (auto taken = take_parameters(reader, submap); !taken) {
      return tl::make_unexpected(taken.error());
    }
  }
  const Status taken = version >= kConsideredRecords
                           ? take_markers<map_considered_marker_t>(reader, record->markers, submap)
                           : take_markers<map_marker_t>(reader, record->markers, submap);
  if (!taken) return tl::make_unexpected(taken.error());
  if (version < kWorldRecords) make_zeros_unknown(submap);
  return submap;
}

}  // namespace

std::uint32_t record_version(const MarkerMap& map) {
  return map.considered() ? kConsideredRecords : kWorldRecords;
}

std::string encode_records(const MarkerMap& map) {
  const bool considered = record_version(map) >= kConsideredRecords;
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
    if (considered) append_parameters(submap, bytes);
    for (const MapMarker& marker : submap.markers) {
      if (considered) {
        append(bytes, record_of<map_considered_marker_t>(marker));
      } else {
        append(bytes, record_of<map_marker_t>(marker));
      }
    }
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
