#include "locd/frames/frame_synchronizer.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;

/// Counts buffers that have not been given back.
class Lender final : public FrameLender {
 public:
  Frame lend(Stamp stamp) {
    ++lent;
    FrameInfo info;
    info.stamp = stamp;
    return Frame(info, {}, nullptr, this, 0);
  }
  void take_back(std::uint32_t /*slot*/) noexcept override { --lent; }
  int lent = 0;
};

/// One arrival: at `at_ms` camera `camera` delivers a frame stamped `stamp_ms`; −1: only time goes.
struct Arrival {
  int at_ms;
  int camera;
  int stamp_ms;
};

/// Sets as text: "0:10 2:12 | 0:43" are two sets, of cameras 0 and 2, and of camera 0.
std::string play(FrameSynchronizer& sync, Lender& lender, const std::vector<Arrival>& arrivals) {
  std::string text;
  for (const Arrival& arrival : arrivals) {
    const Stamp now = milliseconds(arrival.at_ms);
    if (arrival.camera >= 0) {
      sync.push(static_cast<std::size_t>(arrival.camera),
                lender.lend(milliseconds(arrival.stamp_ms)), now);
    }
    while (auto set = sync.take(now)) {
      if (!text.empty()) text += " | ";
      bool first = true;
      for (std::size_t c = 0; c < kMaxCameras; ++c) {
        if (!set->has(c)) continue;
        if (!first) text += ' ';
        first = false;
        text += std::to_string(c) + ':' +
                std::to_string(
                    std::chrono::duration_cast<milliseconds>(set->frames[c].stamp()).count());
      }
    }
  }
  return text;
}

SyncOptions options_of(int tolerance_ms, int deadline_ms) {
  SyncOptions options;
  options.tolerance = milliseconds(tolerance_ms);
  options.deadline = milliseconds(deadline_ms);
  return options;
}

struct Case {
  const char* name;
  SyncOptions options;
  std::vector<Arrival> arrivals;
  const char* sets;
};

class Synchronizing : public testing::TestWithParam<Case> {};

TEST_P(Synchronizing, MakesTheseSets) {
  Lender lender;
  {
    FrameSynchronizer sync(3, GetParam().options);
    EXPECT_EQ(play(sync, lender, GetParam().arrivals), GetParam().sets);
  }
  EXPECT_EQ(lender.lent, 0) << "every buffer is given back";
}

INSTANTIATE_TEST_SUITE_P(
    Table, Synchronizing,
    testing::Values(
        Case{"triggered",
             options_of(5, 25),
             {{1, 0, 0}, {2, 1, 0}, {3, 2, 1}, {34, 2, 33}, {35, 0, 33}, {36, 1, 34}},
             "0:0 1:0 2:1 | 0:33 1:34 2:33"},
        Case{"tolerance_is_inclusive",
             options_of(5, 25),
             {{1, 0, 0}, {2, 1, 5}, {3, 2, 2}},
             "0:0 1:5 2:2"},
        Case{"free_running",
             options_of(25, 40),
             {{1, 0, 0}, {12, 1, 11}, {23, 2, 22}, {34, 0, 33}, {45, 1, 44}, {56, 2, 55}},
             "0:0 1:11 2:22 | 0:33 1:44 2:55"},
        Case{"on_a_mismatch_only_the_oldest_goes",
             options_of(5, 100),
             {{1, 0, 0}, {34, 1, 33}, {35, 2, 34}, {36, 0, 33}},
             "0:33 1:33 2:34"},
        Case{"deadline_gives_a_partial_set",
             options_of(5, 25),
             {{1, 0, 0}, {2, 1, 0}, {25, -1, 0}, {26, -1, 0}},
             "0:0 1:0"},
        Case{"a_late_frame_does_not_come_again",
             options_of(5, 25),
             {{1, 0, 0}, {2, 1, 0}, {26, -1, 0}, {27, 2, 1}, {34, 0, 33}, {35, 1, 33}, {36, 2, 33}},
             "0:0 1:0 | 0:33 1:33 2:33"},
        Case{"fast_cameras_lose_no_frame",
             options_of(5, 25),
             {{1, 0, 0},
              {2, 1, 0},
              {3, 2, 0},
              {6, 0, 5},
              {7, 1, 5},
              {8, 2, 4},
              {9, 0, 8},
              {10, 1, 8},
              {11, 2, 8}},
             "0:0 1:0 2:0 | 0:5 1:5 2:4 | 0:8 1:8 2:8"},
        Case{"what_missed_its_set_is_late_whoever_was_in_it_is_not",
             options_of(5, 25),
             {{1, 0, 0}, {2, 1, 0}, {26, -1, 0}, {27, 2, 5}, {28, 0, 5}, {29, 1, 5}, {30, 2, 6}},
             "0:0 1:0 | 0:5 1:5 2:6"},
        Case{"newest_wins",
             options_of(5, 100),
             {{1, 0, 0}, {34, 0, 33}, {35, 1, 33}, {36, 2, 33}},
             "0:33 1:33 2:33"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(FrameSynchronizer, AMicrosecondBeyondTheToleranceIsAnotherSet) {
  for (const auto& [beyond, together] :
       {std::pair(Stamp{0}, true), {std::chrono::microseconds(1), false}}) {
    Lender lender;
    FrameSynchronizer sync(2, options_of(5, 25));
    sync.push(0, lender.lend(Stamp{0}), milliseconds(1));
    sync.push(1, lender.lend(milliseconds(5) + beyond), milliseconds(6));
    EXPECT_EQ(sync.take(milliseconds(6)).has_value(), together);
  }
}

TEST(FrameSynchronizer, ADeadCameraLeavesTheQuorumAndRejoins) {
  SyncOptions options = options_of(5, 25);
  options.leave_after_sets = 3;
  Lender lender;
  FrameSynchronizer sync(2, options);
  std::vector<Arrival> arrivals;
  for (int i = 0; i < 3; ++i) {  // camera 1 is dead: three sets wait for the deadline
    arrivals.push_back({100 * i, 0, 100 * i});
    arrivals.push_back({100 * i + 25, -1, 0});
  }
  EXPECT_EQ(play(sync, lender, arrivals), "0:0 | 0:100 | 0:200");
  EXPECT_EQ(sync.quorum(), camera_bit(0));
  EXPECT_EQ(play(sync, lender, {{300, 0, 300}}), "0:300") << "nobody waits for it any more";
  EXPECT_EQ(play(sync, lender, {{401, 1, 400}}), "");
  EXPECT_EQ(sync.quorum(), camera_bit(0) | camera_bit(1)) << "it delivers: it is waited for";
  EXPECT_EQ(play(sync, lender, {{402, 0, 400}}), "0:400 1:400");
}

TEST(FrameSynchronizer, CountsEveryDropByReason) {
  SyncOptions options = options_of(5, 25);
  options.min_cameras = 2;
  Lender lender;
  FrameSynchronizer sync(2, options);
  const auto dropped = [&](std::size_t camera, DropReason reason) {
    return sync.dropped(camera)[static_cast<std::size_t>(reason)];
  };
  EXPECT_EQ(play(sync, lender, {{0, 0, 0}, {10, 0, 10}}), "");
  EXPECT_EQ(dropped(0, DropReason::overtaken), 1U);
  EXPECT_EQ(play(sync, lender, {{20, 1, 30}}), "");
  EXPECT_EQ(dropped(0, DropReason::mismatched), 1U);
  EXPECT_EQ(play(sync, lender, {{45, -1, 0}}), "");
  EXPECT_EQ(dropped(1, DropReason::too_few), 1U);
  EXPECT_EQ(play(sync, lender, {{46, 0, 32}}), "");
  EXPECT_EQ(dropped(0, DropReason::late), 1U);
  EXPECT_EQ(lender.lent, 0);
}

TEST(FrameSynchronizer, DeadlineIsThatOfTheFirstArrival) {
  Lender lender;
  FrameSynchronizer sync(3, options_of(5, 25));
  EXPECT_FALSE(sync.next_deadline());
  EXPECT_EQ(play(sync, lender, {{7, 1, 5}, {9, 0, 5}}), "");
  EXPECT_EQ(sync.next_deadline(), milliseconds(32));
}

TEST(FrameSetLease, TellsItsStamps) {
  FrameSetLease set;
  EXPECT_EQ(set.max_skew(), Stamp{0});
  const auto put = [&](std::size_t camera, Stamp stamp) {
    FrameInfo info;
    info.stamp = stamp;
    set.frames[camera] = Frame(info, {}, nullptr, nullptr, 0);
    set.cameras |= camera_bit(camera);
  };
  // Today's times: their sum would not fit into 64 bits of nanoseconds for 6 cameras.
  const Stamp today = std::chrono::seconds(1'700'000'000);
  for (std::size_t c = 1; c < 9; ++c) put(c, today + milliseconds(c));
  EXPECT_EQ(set.set_stamp(), today + milliseconds(1));
  EXPECT_EQ(set.mean_stamp(), today + std::chrono::microseconds(4500));
  EXPECT_EQ(set.max_skew(), milliseconds(7));
}

TEST(SyncOptions, AreHeldToTheirRanges) {
  using Options = SyncOptions;
  expect_ranges<Options>(
      {ranged("tolerance in us", &Options::tolerance, Options::kTolerance_us, 1),
       ranged("deadline in ms", &Options::deadline, Options::kDeadline_ms, 1000),
       ranged("min_cameras", &Options::min_cameras, Options::kMinCameras),
       ranged("leave_after_sets", &Options::leave_after_sets, Options::kLeaveAfterSets)});
}

}  // namespace
}  // namespace waymark
