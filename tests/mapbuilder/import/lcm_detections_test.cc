#include "mapbuilder/import/lcm_detections.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/lcm_log_text.h"
#include "tests/support/peak_memory.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using test::detections_message;
using test::encoded;
using test::lcm_event;
using testing::HasSubstr;

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};  // NOLINT: bytes
}

Expected<LoggedSet> decoded(const detections_t& message) {
  const std::string bytes = encoded(message);
  return decode_detections(bytes_of(bytes));
}

Expected<LoggedDetections> read(const std::string& log, const std::string& channel = {}) {
  const TemporaryFolder folder;
  Progress progress(false);
  return read_lcm_detections(folder.write("a.lcm", log), channel, progress);
}

std::string event_of(int set, const std::string& channel = "WAYMARK_DETECTIONS") {
  return lcm_event(channel, encoded(detections_message(set)));
}

TEST(LcmDetections, AMessageIsAFrameSet) {
  const auto set = decoded(detections_message(4));
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->sequence, 4);
  EXPECT_EQ(set->session, "0123456789abcdef");
  EXPECT_EQ(set->rig_fingerprint, "00112233aabbccdd");
  EXPECT_EQ(set->cameras, 3U);
  ASSERT_EQ(set->images.size(), 2U) << "cam1 gave no frame";
  EXPECT_EQ(set->images[0].stamp, Stamp(1'700'000'000'400'000'000 - 1500));
  EXPECT_EQ(set->images[1].stamp, Stamp(1'700'000'000'400'000'000 + 1500));
  EXPECT_EQ(set->images[1].camera, 2);
  EXPECT_TRUE(set->images[1].detections.empty());
  ASSERT_EQ(set->images[0].detections.size(), 1U);
  const Detection& marker = set->images[0].detections[0];
  EXPECT_EQ(marker.marker, (MarkerId{Family::tag36h11, 12}));
  EXPECT_EQ(marker.corners[0], Eigen::Vector2d(10.5, 20.25));
  EXPECT_EQ(marker.corners[3], Eigen::Vector2d(10, 40));
  ASSERT_TRUE(marker.covariances);
  const Eigen::Matrix2d first = (Eigen::Matrix2d() << 0.25, 0.125, 0.125, 0.5).finished();
  EXPECT_TRUE((*marker.covariances)[0].isApprox(first, 1e-6));
}

TEST(LcmDetections, CovariancesAreOnesOrNone) {
  detections_t m = detections_message(0);
  m.covariances_px2[0].assign(12, std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(decoded(m)->images[0].detections[0].covariances);
  m.covariances_px2[0].assign(
      {1, 1, 1, 1, 0, 1, 1, 0, 1, 1, 0, 1});  // float's rounding of a needle
  const auto needle = decoded(m);
  ASSERT_TRUE(needle) << needle.error().message;
  EXPECT_GT((*needle->images[0].detections[0].covariances)[0].determinant(), 0);
  for (const float wrong : {2.0F, std::numeric_limits<float>::quiet_NaN()}) {
    m.covariances_px2[0][1] = wrong;
    EXPECT_FALSE(decoded(m));
  }
}

TEST(LcmDetections, DamagedMessagesAreRefused) {
  const std::string good = encoded(detections_message(0));
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(decode_detections(bytes_of(good).first(size))) << size;
  }
  EXPECT_FALSE(decode_detections(bytes_of(good + "x")));
  detections_t m = detections_message(0);
  m.camera[0] = 1;
  EXPECT_THAT(decoded(m).error().message, HasSubstr("gave no frame"));
  m = detections_message(0);
  m.family[0] = "tag99";
  EXPECT_THAT(decoded(m).error().message, HasSubstr("no family"));
  m = detections_message(0);
  m.marker_id[0] = 587;
  EXPECT_THAT(decoded(m).error().message, HasSubstr("has no 587"));
  m = detections_message(0);
  m.corners_px[0][3] = 1.5e6F;
  EXPECT_THAT(decoded(m).error().message, HasSubstr("no pixel"));
}

TEST(LcmDetections, CamerasAreCounted) {
  detections_t m = detections_message(0);
  m.camera_count = 64;
  m.camera_offset_us.assign(64, 0);
  EXPECT_TRUE(decoded(m));
  m.camera_count = 65;
  m.camera_offset_us.assign(65, 0);
  EXPECT_THAT(decoded(m).error().message, HasSubstr("65 cameras"));
}

TEST(LcmDetections, WhatAMessageStatesTakesNoMemory) {
  const std::string good = encoded(detections_message(0));
  // Behind the hash, times, two texts of 21 bytes, cameras with their offsets.
  const std::size_t at = 8 + 8 + 8 + 21 + 21 + 4 + 24;
  std::string many = good;
  many.replace(at, 4, "\x7F\xFF\xFF\xFF", 4);
  const std::size_t memory = test::peak_memory([&] {
    EXPECT_THAT(decode_detections(bytes_of(many)).error().message, HasSubstr("2147483647 markers"));
  });
  EXPECT_LT(memory, 50'000'000U);
}

TEST(LcmDetections, ALogIsACapture) {
  std::string log;
  for (int set = 0; set < 5; ++set) {
    log += lcm_event("WAYMARK_POSE", "another message") + event_of(set);
  }
  log += event_of(4);  // the network gave it twice
  const auto logged = read(log);
  ASSERT_TRUE(logged) << logged.error().message;
  EXPECT_EQ(logged->channel, "WAYMARK_DETECTIONS");
  EXPECT_EQ(logged->frame_sets, 5U);
  EXPECT_EQ(logged->images.size(), 10U);
  EXPECT_EQ(logged->sync_tolerance, kDefaultSyncTolerance);
}

TEST(LcmDetections, FramesOfASetStayTogether) {
  detections_t m = detections_message(0);
  m.camera_offset_us[2] = 20'000;
  const auto logged = read(lcm_event("D", encoded(m)));
  ASSERT_TRUE(logged);
  EXPECT_GE(logged->sync_tolerance, Stamp(20'001'500));
}

TEST(LcmDetections, LogsThatAreNoCaptureSayWhy) {
  EXPECT_THAT(read(lcm_event("POSE", "x")).error().message, HasSubstr("[lcm] detections = true"));
  EXPECT_THAT(read(lcm_event("WAYMARK_DETECTIONS", "of 2025")).error().message,
              HasSubstr("another version of Waymark"));
  const std::string two = event_of(0, "A") + event_of(1, "B");
  EXPECT_THAT(read(two).error().message, HasSubstr("--channel"));
  const auto chosen = read(two, "B");
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->frame_sets, 1U);
  detections_t other = detections_message(1);
  other.rig = "ffffffffffffffff";
  EXPECT_THAT(read(event_of(0) + lcm_event("WAYMARK_DETECTIONS", encoded(other))).error().message,
              HasSubstr("one rig"));
  other = detections_message(0);
  other.seq = 9;
  EXPECT_THAT(read(event_of(0) + lcm_event("WAYMARK_DETECTIONS", encoded(other))).error().message,
              HasSubstr("two images of cam0"));
}

TEST(LcmDetections, MemoryIsThatOfTheLog) {
  std::string log;
  while (log.size() < 20'000'000) {
    log += event_of(static_cast<int>(log.size() / 100));
  }
  const TemporaryFolder folder;
  const auto path = folder.write("a.lcm", log);
  Progress progress(false);
  const std::size_t memory =
      test::peak_memory([&] { EXPECT_TRUE(read_lcm_detections(path, {}, progress)); });
  EXPECT_LT(memory, 50'000'000 + 20 * log.size());
}

}  // namespace
}  // namespace waymark
