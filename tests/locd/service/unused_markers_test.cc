#include "locd/service/unused_markers.h"

#include <gtest/gtest.h>

#include "drivers/monotonic_clock.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

constexpr MarkerId kTwelve{Family::tag36h11, 12};
constexpr MarkerId kSeven{Family::tag36h11, 7};
constexpr const char* kHall = "00000000000000aa";
constexpr const char* kOther = "00000000000000bb";

QuarantinedMarker moved(const MarkerId& marker) { return {marker, QuarantineState::moved, 0, 0.5}; }

class UnusedMarkersTest : public testing::Test {
 protected:
  /// What stands in the file once it is written.
  [[nodiscard]] Quarantine written() {
    EXPECT_TRUE(file_.settle(monotonic_now() + std::chrono::seconds(20)));
    const auto read = read_quarantine(path_);
    EXPECT_TRUE(read) << read.error().message;
    return read ? *read : Quarantine{};
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "quarantine.json";
  QuarantineFile file_{path_};
};

TEST_F(UnusedMarkersTest, WhatIsIgnoredIsKeptOverRestartsAndMaps) {
  {
    UnusedMarkers unused(file_, kHall);
    ASSERT_TRUE(unused.ignore(kTwelve, 5));
    ASSERT_TRUE(unused.ignore(kTwelve, 6));
    ASSERT_TRUE(unused.ignore(kSeven, 7));
    unused.set_found(kHall, {moved({Family::tag36h11, 3})}, 8);
    ASSERT_EQ(written().markers.size(), 3U);
    EXPECT_EQ(written().markers[2].since_utime, 5);
  }
  for (const char* hash : {kHall, kOther, ""}) {
    QuarantineFile file(path_);
    const UnusedMarkers unused(file, hash);
    EXPECT_EQ(unused.ignored(), (std::vector<MarkerId>{kSeven, kTwelve})) << hash;
    EXPECT_EQ(unused.quarantined(), hash == std::string(kHall) ? 1U : 0U) << hash;
  }
}

TEST_F(UnusedMarkersTest, AMarkerIsAllowedOnce) {
  UnusedMarkers unused(file_, kHall);
  EXPECT_EQ(unused.allow(kTwelve).error().kind, ErrorKind::bad_data);
  ASSERT_TRUE(unused.ignore(kTwelve, 5));
  EXPECT_TRUE(unused.allow(kTwelve));
  EXPECT_TRUE(written().markers.empty());
  EXPECT_EQ(unused.allow(kTwelve).error().kind, ErrorKind::bad_data);
}

TEST_F(UnusedMarkersTest, OnlySoManyAreIgnored) {
  UnusedMarkers unused(file_, kHall);
  for (int i = 0; i < static_cast<int>(UnusedMarkers::kMostIgnored); ++i) {
    ASSERT_TRUE(unused.ignore({Family::tag36h11, i}, 5));
  }
  EXPECT_EQ(unused.ignore({Family::tag36h11, 500}, 5).error().kind, ErrorKind::usage);
  EXPECT_EQ(unused.ignored().size(), UnusedMarkers::kMostIgnored);
}

TEST_F(UnusedMarkersTest, AMarkerThatIsBothStandsThereOnce) {
  UnusedMarkers unused(file_, kHall);
  unused.set_found(kHall, {moved(kTwelve)}, 5);
  EXPECT_TRUE(unused.is_quarantined(kTwelve));
  ASSERT_TRUE(unused.ignore(kTwelve, 6));
  ASSERT_EQ(written().markers.size(), 1U);
  EXPECT_EQ(written().markers[0].state, QuarantineState::ignored);
}

TEST_F(UnusedMarkersTest, WithoutAMapTheQuarantineOfTheLastOneStays) {
  {
    UnusedMarkers unused(file_, kHall);
    unused.set_found(kHall, {moved(kTwelve)}, 5);
    (void)written();
  }
  QuarantineFile file(path_);
  UnusedMarkers unused(file, "");
  EXPECT_FALSE(unused.is_quarantined(kTwelve));
  ASSERT_TRUE(unused.ignore(kSeven, 6));
  ASSERT_TRUE(file.settle(monotonic_now() + std::chrono::seconds(20)));
  const Quarantine kept = written();
  EXPECT_EQ(kept.map_hash, kHall);
  EXPECT_EQ(kept.markers.size(), 2U);
}

TEST_F(UnusedMarkersTest, SinceWhenIsKeptWhileItLasts) {
  UnusedMarkers unused(file_, kHall);
  unused.set_found(kHall, {moved(kTwelve)}, 5);
  unused.set_found(kHall, {moved(kSeven), moved(kTwelve)}, 9);
  EXPECT_EQ(written().markers[0].since_utime, 9);
  EXPECT_EQ(written().markers[1].since_utime, 5);
  unused.set_found(kOther, {}, 10);  // a map's that is used no more
  EXPECT_EQ(unused.quarantined(), 2U);
}

}  // namespace
}  // namespace waymark
