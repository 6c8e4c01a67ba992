#include "core/map/map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/crc.hpp>
#include <cmath>
#include <filesystem>
#include <waymark/map_capture_t.hpp>
#include <waymark/map_header_t.hpp>
#include <waymark/map_marker_t.hpp>
#include <waymark/map_parameters_t.hpp>
#include <waymark/map_submap_t.hpp>
#include <waymark/map_world_t.hpp>

#include "core/base/atomic_file.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::size_t kHeaderSize = 24;

std::string encoded(const MarkerMap& map) {
  auto bytes = encode_map(map);
  EXPECT_TRUE(bytes) << bytes.error().message;
  return *std::move(bytes);
}

/// The message with which bytes are refused.
std::string refusal(const std::string& bytes) {
  const auto map = decode_map(bytes, "a.map");
  if (map) return "accepted";
  EXPECT_EQ(map.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(map.error().message, AllOf(StartsWith("a.map: "), Not(HasSubstr("\n"))));
  return map.error().message;
}

/// A container with a right checksum around `payload`, written by another hand.
std::string container(const std::string& payload, std::uint32_t version = 2) {
  std::string bytes = "WAYMARK\n";
  const auto put = [&](std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i, value >>= 8) bytes += static_cast<char>(value & 0xFF);
  };
  put(version, 4);
  put(payload.size(), 8);
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  crc.process_bytes(payload.data(), payload.size());
  put(crc.checksum(), 4);
  return bytes + payload;
}

template <typename Record>
std::string record_bytes(const Record& record) {
  std::string bytes(static_cast<std::size_t>(record.getEncodedSize()), '\0');
  EXPECT_EQ(record.encode(bytes.data(), 0, record.getEncodedSize()), record.getEncodedSize());
  return bytes;
}

/// Payload of a map with one marker, before which its records can be changed.
struct OneMarker {
  map_header_t header{};
  map_submap_t submap{};
  map_world_t world{};
  map_marker_t marker{};

  OneMarker() {
    header.submaps = 1;
    submap.markers = 1;
    marker.family = 20;
    marker.number = 5;
    marker.size_m = marker.stated_size_m = 0.1;
    marker.world_from_marker_xyzw[3] = 1;
  }
  [[nodiscard]] std::string file() const {
    return container(record_bytes(header) + record_bytes(submap) + record_bytes(world) +
                     record_bytes(marker));
  }
  [[nodiscard]] std::string file_of_version_1() const {
    return container(record_bytes(header) + record_bytes(submap) + record_bytes(marker), 1);
  }
};

void expect_same(const MarkerMap& a, const MarkerMap& b) {
  EXPECT_EQ(a.builder_version, b.builder_version);
  EXPECT_EQ(a.rig_fingerprint, b.rig_fingerprint);
  EXPECT_EQ(a.capture_fingerprints, b.capture_fingerprints);
  ASSERT_EQ(a.submaps.size(), b.submaps.size());
  for (std::size_t s = 0; s < a.submaps.size(); ++s) {
    EXPECT_EQ(a.submaps[s].frame, b.submaps[s].frame);
    EXPECT_EQ(a.submaps[s].z_is_up, b.submaps[s].z_is_up);
    EXPECT_EQ(a.submaps[s].frame_sets, b.submaps[s].frame_sets);
    EXPECT_EQ(a.submaps[s].rms_px, b.submaps[s].rms_px);
    EXPECT_EQ(a.submaps[s].rms_all_px, b.submaps[s].rms_all_px);
    EXPECT_EQ(a.submaps[s].parameter_covariance, b.submaps[s].parameter_covariance);
    ASSERT_EQ(a.submaps[s].parameters.size(), b.submaps[s].parameters.size());
    for (std::size_t p = 0; p < a.submaps[s].parameters.size(); ++p) {
      EXPECT_EQ(a.submaps[s].parameters[p].name, b.submaps[s].parameters[p].name);
      EXPECT_EQ(a.submaps[s].parameters[p].serial, b.submaps[s].parameters[p].serial);
      EXPECT_EQ(a.submaps[s].parameters[p].cross, b.submaps[s].parameters[p].cross);
    }
    ASSERT_EQ(a.submaps[s].markers.size(), b.submaps[s].markers.size());
    for (std::size_t m = 0; m < a.submaps[s].markers.size(); ++m) {
      const MapMarker& x = a.submaps[s].markers[m];
      const MapMarker& y = b.submaps[s].markers[m];
      EXPECT_EQ(x.id, y.id);
      EXPECT_EQ(x.stated_size_m, y.stated_size_m);
      EXPECT_EQ(x.size_m, y.size_m);
      EXPECT_EQ(x.world_from_marker.translation, y.world_from_marker.translation);
      EXPECT_EQ(x.world_from_marker.rotation.coeffs(), y.world_from_marker.rotation.coeffs());
      EXPECT_EQ(x.covariance, y.covariance);
      EXPECT_EQ(x.considered(), y.considered());
      EXPECT_EQ(x.metric(), y.metric());
      EXPECT_EQ(x.modes, y.modes);
      EXPECT_EQ(x.observations, y.observations);
      EXPECT_EQ(x.rejected, y.rejected);
      EXPECT_EQ(x.rms_px, y.rms_px);
      EXPECT_EQ(x.verified, y.verified);
    }
  }
}

TEST(MapFile, EveryFieldComesBackBitForBit) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.map";
  ASSERT_TRUE(write_map_file(path, test::small_map()));
  const auto map = read_map_file(path);
  ASSERT_TRUE(map) << map.error().message;
  expect_same(*map, test::small_map());
}

TEST(MapFile, WhatAMapConsidersComesBackToo) {
  const MarkerMap map = test::considered_small_map();
  const auto back = decode_map(encoded(map), "a.map");
  ASSERT_TRUE(back) << back.error().message;
  expect_same(*back, map);
  EXPECT_EQ(encoded(*back), encoded(map));
  EXPECT_EQ(encoded(map).substr(8, 4), std::string("\x03\0\0\0", 4));
  EXPECT_NE(content_hash(map), content_hash(test::small_map()));
}

TEST(MapFile, TheSameMapGivesTheSameBytes) {
  EXPECT_EQ(encoded(test::small_map()), encoded(test::small_map()));
  EXPECT_EQ(encoded(*decode_map(encoded(test::small_map()), "a.map")), encoded(test::small_map()));
}

TEST(MapFile, LayoutIsAsDocumented) {
  const std::string bytes = encoded(test::small_map());
  // Records: 8 bytes of type, then the fields.
  constexpr std::size_t kHeader = 8 + 4 + 4 + 32 + 16;
  constexpr std::size_t kCapture = 8 + 16;
  constexpr std::size_t kSubmap = 8 + 3 * 4 + 2 * 8;
  constexpr std::size_t kWorld = 8 + 1;
  constexpr std::size_t kMarker = 8 + 2 * 4 + (2 + 3 + 4 + 36) * 8 + 2 * 4 + 8 + 1;
  constexpr std::size_t kPayload = kHeader + 2 * kCapture + 2 * (kSubmap + kWorld) + 5 * kMarker;
  ASSERT_EQ(bytes.size(), kHeaderSize + kPayload);
  EXPECT_EQ(bytes, container(bytes.substr(kHeaderSize)));
  EXPECT_EQ(bytes.substr(8, 4), std::string("\x02\0\0\0", 4));
}

TEST(MapFile, LayoutOfVersion3IsAsDocumented) {
  const std::string bytes = encoded(test::considered_small_map());
  constexpr std::size_t kHeader = 8 + 4 + 4 + 32 + 16;
  constexpr std::size_t kCapture = 8 + 16;
  constexpr std::size_t kSubmap = 8 + 3 * 4 + 2 * 8 + 8 + 1 + 8 + 4;
  constexpr std::size_t kParameter = 8 + 48 + 64 + 16 * 8;
  constexpr std::size_t kMarker =
      8 + 2 * 4 + (2 + 3 + 4 + 21) * 8 + (6 * 16 + 21) * 4 + 2 * 4 + 8 + 1;
  static_assert(kMarker * 20'000 < 16'000'000);
  ASSERT_EQ(bytes.size(), kHeaderSize + kHeader + 2 * kCapture + 2 * kSubmap + 2 * kParameter +
                              3 * (8 + 8) + 5 * kMarker);
  EXPECT_EQ(bytes, container(bytes.substr(kHeaderSize), 3));
}

TEST(MapFile, ChecksumIsCrc32c) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes("123456789", 9);
  EXPECT_EQ(crc.checksum(), 0xE3069283U);
}

TEST(MapFile, HashNamesTheContent) {
  const std::string hash = content_hash(test::small_map());
  EXPECT_THAT(hash, ::testing::MatchesRegex("[0-9a-f]{16}"));
  EXPECT_EQ(hash, content_hash(*decode_map(encoded(test::small_map()), "a.map")));
  MarkerMap moved = test::small_map();
  moved.submaps[1].markers[0].world_from_marker.translation.x() = 1e-15;
  EXPECT_NE(content_hash(moved), hash);
}

TEST(MapFile, OtherFilesAreNoMaps) {
  EXPECT_THAT(refusal(""), HasSubstr("no marker map"));
  EXPECT_THAT(refusal("id tx ty tz\n"), HasSubstr("no marker map"));
  EXPECT_THAT(refusal(std::string(1000, '\0')), HasSubstr("no marker map"));
  EXPECT_THAT(refusal("WAYMARK\r\n" + std::string(100, '\0')), HasSubstr("no marker map"));
}

TEST(MapFile, NewerVersionsAreNamed) {
  const std::string payload = encoded(test::small_map()).substr(kHeaderSize);
  EXPECT_EQ(refusal(container(payload)), "accepted");
  EXPECT_THAT(refusal(container(payload, 4)),
              AllOf(HasSubstr("version 4, newer than version 3"), HasSubstr("update Waymark")));
  EXPECT_THAT(refusal(container(payload, 3)), HasSubstr("no map_parameters_t record"));
  EXPECT_THAT(refusal(container(payload, 0)), HasSubstr("damaged"));
}

TEST(MapFile, AFileOfVersion1IsReadAsItWasMeant) {
  OneMarker old;
  const auto map = decode_map(old.file_of_version_1(), "a.map");
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_FALSE(map->submaps[0].markers[0].covariance_known()) << "zero stood for unknown";
  EXPECT_FALSE(map->submaps[0].z_is_up);
  old.submap.frame = static_cast<int>(FrameKind::facility);
  old.marker.covariance[0] = 1e-6;
  const auto surveyed = decode_map(old.file_of_version_1(), "a.map");
  ASSERT_TRUE(surveyed) << surveyed.error().message;
  EXPECT_TRUE(surveyed->submaps[0].z_is_up);
  EXPECT_EQ(surveyed->submaps[0].markers[0].covariance(0, 0), 1e-6);
  // Written again it is of the present version.
  EXPECT_EQ(encoded(*surveyed).substr(8, 4), std::string("\x02\0\0\0", 4));
  EXPECT_THAT(refusal(container(old.file().substr(kHeaderSize), 1)), HasSubstr("no map_marker_t"));
}

/// Files written from docs/map_format.md, once and for all.
MarkerMap golden(const std::string& name) {
  auto map = read_map_file(std::filesystem::path(WAYMARK_GOLDEN_MAPS) / name);
  EXPECT_TRUE(map) << map.error().message;
  return map ? *std::move(map) : MarkerMap{};
}

/// What both hold alike.
void expect_golden(const MarkerMap& map) {
  ASSERT_EQ(map.submaps.size(), 2U);
  EXPECT_EQ(map.submaps[0].frame_sets, 42U);
  EXPECT_EQ(map.submaps[0].rms_all_px, 0.5);
  ASSERT_EQ(map.submaps[0].markers.size(), 2U);
  const MapMarker& marker = map.submaps[0].markers[0];
  EXPECT_EQ(marker.id, (MarkerId{Family::tag36h11, 3}));
  EXPECT_EQ(marker.stated_size_m, 0.12);
  EXPECT_EQ(marker.size_m, 0.1205);
  EXPECT_EQ(marker.world_from_marker.translation, Eigen::Vector3d(1.5, -0.25, 0.125));
  EXPECT_EQ(marker.world_from_marker.rotation.coeffs(), Eigen::Vector4d(0.5, 0.5, 0.5, 0.5));
  EXPECT_EQ(marker.covariance(2, 2), 3e-6);
  EXPECT_EQ(marker.observations, 13U);
  EXPECT_EQ(marker.rejected, 1U);
  EXPECT_EQ(marker.rms_px, 0.25);
  EXPECT_TRUE(marker.verified);
  EXPECT_FALSE(map.submaps[0].markers[1].covariance_known());
  EXPECT_FALSE(map.submaps[0].markers[1].verified);
  EXPECT_TRUE(map.submaps[0].z_is_up);
  EXPECT_FALSE(map.submaps[1].z_is_up);
  EXPECT_EQ(map.submaps[1].markers.at(0).id, (MarkerId{Family::aruco_4x4_50, 7}));
}

TEST(MapFile, TheGoldenFileOfVersion1IsRead) {
  const MarkerMap map = golden("version_1.map");
  expect_golden(map);
  EXPECT_EQ(map.builder_version, "0.0.9");
  EXPECT_EQ(map.rig_fingerprint, "0123456789abcdef");
  EXPECT_EQ(map.submaps[0].frame, FrameKind::facility);
  EXPECT_TRUE(map.submaps[1].markers[0].covariance_known());
}

TEST(MapFile, TheGoldenFileOfVersion2IsReadAndWrittenAsItIs) {
  const MarkerMap map = golden("version_2.map");
  expect_golden(map);
  EXPECT_EQ(map.rig_fingerprint, "");
  EXPECT_EQ(map.submaps[0].frame, FrameKind::scaled);
  EXPECT_TRUE(map.submaps[1].markers[0].covariance.isZero(0)) << "known exactly";
  const auto bytes = read_file(std::filesystem::path(WAYMARK_GOLDEN_MAPS) / "version_2.map");
  EXPECT_EQ(encoded(map), *bytes);
  EXPECT_EQ(content_hash(map), "e15bdf8e774f655a");
}

TEST(MapFile, TheGoldenFileOfVersion3IsReadAndWrittenAsItIs) {
  const MarkerMap map = golden("version_3.map");
  ASSERT_EQ(map.submaps.size(), 2U);
  ASSERT_EQ(map.submaps[0].parameters.size(), 2U);
  EXPECT_EQ(map.submaps[0].parameters[0].name, "cam0 focal length");
  EXPECT_EQ(map.submaps[0].parameters[0].serial, "00417");
  EXPECT_EQ(map.submaps[0].parameters[0].cross[0], 0.5e-3);
  EXPECT_EQ(map.submaps[0].parameters[1].name, "size 0.12 m");
  EXPECT_EQ(map.submaps[0].parameter_covariance(1, 0), 2.5e-7);
  const MapMarker& marker = map.submaps[0].markers.at(0);
  EXPECT_EQ(marker.id, (MarkerId{Family::tag36h11, 3}));
  EXPECT_EQ(marker.covariance_metric(2, 2), 3e-6);
  EXPECT_EQ(marker.covariance_metric(1, 0), 2.5e-7);
  EXPECT_EQ(marker.covariance(0, 0), 9.5367431640625e-07);
  EXPECT_EQ(marker.modes(0, 0), 0.0009765625F);
  EXPECT_EQ(marker.modes(5, 15), 0.00048828125F);
  EXPECT_FALSE(map.submaps[0].markers.at(1).considered());
  EXPECT_FALSE(map.submaps[0].markers.at(1).covariance_known());
  EXPECT_TRUE(map.submaps[1].parameters.empty());
  const auto bytes = read_file(std::filesystem::path(WAYMARK_GOLDEN_MAPS) / "version_3.map");
  EXPECT_EQ(encoded(map), *bytes);
}

TEST(MapFile, AMapThatConsidersNothingKeepsItsVersionAndHash) {
  const MarkerMap map = golden("version_2.map");
  EXPECT_FALSE(map.considered());
  EXPECT_EQ(content_hash(map), "e15bdf8e774f655a");
  EXPECT_EQ(map.submaps[1].markers[0].metric(), map.submaps[1].markers[0].covariance);
}

TEST(MapFile, UnknownCovariancesStayUnknownAndExactOnesExact) {
  MarkerMap map = test::small_map();
  map.submaps[0].markers[0].covariance = unknown_covariance();
  map.submaps[0].markers[1].covariance.setZero();
  map.submaps[1].z_is_up = true;
  const auto back = decode_map(encoded(map), "a.map");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_FALSE(back->submaps[0].markers[0].covariance_known());
  EXPECT_TRUE(back->submaps[0].markers[1].covariance.isZero(0));
  EXPECT_FALSE(back->submaps[0].z_is_up);
  EXPECT_TRUE(back->submaps[1].z_is_up);
  EXPECT_EQ(encoded(*back), encoded(map)) << "NaN has one form in files";
}

TEST(MapFile, EveryTruncationIsRefused) {
  const std::string bytes = encoded(test::small_map());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    ASSERT_NE(refusal(bytes.substr(0, length)), "accepted") << length;
  }
  EXPECT_THAT(refusal(bytes.substr(0, bytes.size() - 1)), HasSubstr("truncated"));
  EXPECT_THAT(refusal(bytes + '\0'), HasSubstr("damaged"));
}

TEST(MapFile, EveryFlippedBitIsRefused) {
  std::string bytes = encoded(test::small_map());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    const char mask = static_cast<char>(1 << bit % 8);
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ mask);
    ASSERT_NE(refusal(bytes), "accepted") << bit;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ mask);
  }
  EXPECT_EQ(refusal(bytes), "accepted");
}

TEST(MapFile, EveryByteChangedUnderARightChecksumNeverCrashes) {
  const std::string payload = encoded(test::small_map()).substr(kHeaderSize);
  int refused = 0;
  for (std::size_t at = 0; at < payload.size(); ++at) {
    for (const char value : {'\x00', '\x7F', '\x80', '\xFF'}) {
      std::string changed = payload;
      changed[at] = value;
      refused += refusal(container(changed)) == "accepted" ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 100);
  for (std::size_t length = 0; length < payload.size(); ++length) {
    ASSERT_NE(refusal(container(payload.substr(0, length))), "accepted") << length;
  }
  EXPECT_THAT(refusal(container(payload + "x")), HasSubstr("left over"));
}

TEST(MapFile, DamagedBlocksOfVersion3AreRefused) {
  const std::string bytes = encoded(test::considered_small_map());
  for (std::size_t length = 0; length < bytes.size(); length += 7) {
    ASSERT_NE(refusal(bytes.substr(0, length)), "accepted") << length;
  }
  const std::string payload = bytes.substr(kHeaderSize);
  for (std::size_t length = 0; length < payload.size(); ++length) {
    ASSERT_NE(refusal(container(payload.substr(0, length), 3)), "accepted") << length;
  }
  int refused = 0;
  for (std::size_t at = 0; at < payload.size(); ++at) {
    for (const char value : {'\x7F', '\xFF'}) {
      std::string changed = payload;
      changed[at] = value;
      refused += refusal(container(changed, 3)) == "accepted" ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(MapFile, ParametersAreHeldAgainstTheLength) {
  for (const std::int32_t count : {-1, 100, 65'536, 0x7FFFFFFF, -0x7FFFFFFF}) {
    map_parameters_t parameters{};
    parameters.parameters = count;
    const OneMarker map;
    const std::string payload = record_bytes(map.header) + record_bytes(map.submap) +
                                record_bytes(map.world) + record_bytes(parameters);
    EXPECT_THAT(refusal(container(payload + std::string(2000, 'x'), 3)),
                HasSubstr("parameters don't fit the file"))
        << count;
  }
}

TEST(MapFile, CountsAreHeldAgainstTheLength) {
  EXPECT_EQ(refusal(OneMarker().file()), "accepted");
  for (const std::int32_t count : {-1, 2, 1'000'000, 0x7FFFFFFF, -0x7FFFFFFF}) {
    OneMarker map;
    map.submap.markers = count;
    EXPECT_THAT(refusal(map.file()), HasSubstr("don't fit the file")) << count;
    map = {};
    map.header.submaps = count;
    EXPECT_THAT(refusal(map.file()),
                ::testing::AnyOf(HasSubstr("don't fit the file"), HasSubstr("no map_submap_t")));
    map = {};
    map.header.captures = count;
    EXPECT_THAT(refusal(map.file()),
                ::testing::AnyOf(HasSubstr("don't fit the file"), HasSubstr("no map_capture_t")));
  }
}

TEST(MapFile, SenselessRecordsAreRefused) {
  OneMarker map;
  map.marker.family = 127;
  EXPECT_THAT(refusal(map.file()), HasSubstr("marker 5 of unknown family 127"));
  map = {};
  map.marker.family = -1;
  EXPECT_THAT(refusal(map.file()), HasSubstr("unknown family"));
  map = {};
  map.marker.verified = 2;
  EXPECT_THAT(refusal(map.file()), HasSubstr("verified"));
  map = {};
  map.marker.observations = -1;
  EXPECT_THAT(refusal(map.file()), HasSubstr("observations"));
  map = {};
  map.world.z_is_up = 2;
  EXPECT_THAT(refusal(map.file()), HasSubstr("z_is_up"));
  map = {};
  map.submap.frame = 3;
  EXPECT_THAT(refusal(map.file()), HasSubstr("unknown kind of frame 3"));
  map = {};
  map.submap.markers = 0;
  EXPECT_THAT(refusal(map.file()), HasSubstr("left over"));
  map = {};
  map.marker.covariance[0] = std::nan("");
  EXPECT_THAT(refusal(map.file()), HasSubstr("covariance"));
  map = {};
  map.marker.world_from_marker_xyzw[3] = 0;
  EXPECT_THAT(refusal(map.file()), HasSubstr("tag36h11:5: quaternion is not of unit norm"));
}

TEST(MapFile, AMapThatCouldNotBeReadBackIsNotWritten) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("a.map", "earlier");
  MarkerMap map = test::small_map();
  map.submaps[0].markers[0].covariance(0, 0) = std::nan("");
  const auto status = write_map_file(path, map);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::internal);
  EXPECT_EQ(folder.read("a.map"), "earlier");
}

TEST(MapFile, AFileLargerThanAnyMapIsRefusedUnread) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.map", "");
  const auto refusal_of = [&](std::uintmax_t bytes) {
    std::filesystem::resize_file(path, bytes);  // a hole: it takes no disk
    const auto map = read_map_file(path);
    EXPECT_FALSE(map);
    return map ? Error{ErrorKind::internal, "accepted"} : map.error();
  };
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 28;
  // Not for its size: for the hole that it is.
  EXPECT_THAT(refusal_of(kLargest).message, HasSubstr("sparse"));
  const Error larger = refusal_of(kLargest + 1);
  EXPECT_EQ(larger.kind, ErrorKind::bad_data);
  EXPECT_THAT(larger.message, HasSubstr("larger than 268435456 bytes"));
  EXPECT_THAT(refusal_of(std::uintmax_t{1} << 40).message, HasSubstr("larger than"));
}

TEST(MapFile, AbsentFilesAreNoInput) {
  const test::TemporaryFolder folder;
  const auto map = read_map_file(folder.path() / "absent.map");
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().kind, ErrorKind::no_input);
}

}  // namespace
}  // namespace waymark
