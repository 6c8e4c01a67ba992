#include "locd/pose/frame_detector.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "locd/frames/realtime.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

constexpr int kCameras = 4;

MarkerCatalog tags() {
  MarkerCatalog::FamilyEntry entry;
  entry.family = Family::tag36h11;
  entry.default_size_m = 0.2;
  return MarkerCatalog({entry});
}

/// Images of every camera, without markers.
class Images {
 public:
  explicit Images(const Rig& rig) {
    for (const RigCamera& camera : rig.cameras) {
      const CameraParameters& size = camera.model.parameters();
      images_.emplace_back(size.width_px, size.height_px, 120);
    }
  }
  [[nodiscard]] FrameSetLease set() const {
    FrameSetLease set;
    for (std::size_t c = 0; c < images_.size(); ++c) {
      set.frames[c] = Frame(FrameInfo{}, images_[c].view(), nullptr, nullptr, 0);
      set.cameras |= camera_bit(c);
    }
    return set;
  }

 private:
  std::vector<GrayImage> images_;
};

TEST(FrameDetector, EachWorkerBeginsAsItsCallerWants) {
  const Rig rig = test::ring_rig(kCameras);
  std::mutex mutex;
  std::set<std::thread::id> begun;
  {
    FrameDetector detector(rig, tags(), 3, [&] {
      const std::lock_guard lock(mutex);
      begun.insert(std::this_thread::get_id());
    });
    const Images images(rig);
    for (int i = 0; i < 3; ++i) detector.detect(images.set(), camera_bit(kCameras) - 1);
    for (std::size_t c = 0; c < kCameras; ++c) EXPECT_TRUE(detector.detections_of(c).empty());
  }
  EXPECT_EQ(begun.size(), 2U) << "three threads, of which one is the caller's";
  EXPECT_FALSE(begun.contains(std::this_thread::get_id()));
}

TEST(FrameDetector, WorkersRunAtLocalizationsPriorityWhereTheSystemPermitsIt) {
  const bool permitted = check_realtime().has_value();
  const Rig rig = test::ring_rig(kCameras);
  std::mutex mutex;
  std::vector<std::pair<int, int>> scheduling;
  {
    const FrameDetector detector(rig, tags(), 3, [&] {
      static_cast<void>(make_realtime(kLocalizationPriority));
      sched_param parameters{};
      int policy = -1;
      ::pthread_getschedparam(::pthread_self(), &policy, &parameters);
      const std::lock_guard lock(mutex);
      scheduling.emplace_back(policy, parameters.sched_priority);
    });
  }
  const auto expected =
      permitted ? std::pair(SCHED_FIFO, kLocalizationPriority) : std::pair(SCHED_OTHER, 0);
  EXPECT_EQ(scheduling, std::vector(2, expected));
}

TEST(FrameDetector, WithoutFamiliesOnlyDetectionsThatComeAreThere) {
  const Rig rig = test::ring_rig(2);
  FrameDetector detector(rig, MarkerCatalog(), 2);
  const Images images(rig);
  FrameSetLease set = images.set();
  ImageDetections given;
  given.detections.emplace_back().marker = {Family::tagstandard52h13, 4711};
  set.frames[1] = Frame(FrameInfo{}, {}, &given, nullptr, 0);
  detector.detect(set, 3);
  EXPECT_TRUE(detector.detections_of(0).empty());
  ASSERT_EQ(detector.detections_of(1).size(), 1U);
}

TEST(FrameDetector, AnImageThatTheLibraryFailsOnIsToldAndOthersAreSearched) {
  const Rig rig = test::ring_rig(2);
  FrameDetector detector(rig, tags(), 1);
  const Images images(rig);
  FrameSetLease set = images.set();
  GrayView torn = set.frames[1].image();
  torn.stride_bytes = 1;  // rows that overlap
  set.frames[1] = Frame(FrameInfo{}, torn, nullptr, nullptr, 0);
  detector.detect(set, 0b11);
  EXPECT_EQ(detector.searched(), 0b11U);
  EXPECT_EQ(detector.failed(), 0b10U);
  EXPECT_TRUE(detector.detections_of(1).empty());
  detector.detect(images.set(), 0b01);
  EXPECT_EQ(detector.searched(), 0b01U);
  EXPECT_EQ(detector.failed(), 0U);
}

/// Threads of this process.
std::ptrdiff_t threads() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
}

TEST(FrameDetector, DetectorsMakeNoThreadsOfTheirOwn) {
  const Rig rig = test::ring_rig(2);
  const std::ptrdiff_t before = threads();
  FrameDetector detector(rig, tags(), 2);
  const Images images(rig);
  for (int i = 0; i < 3; ++i) detector.detect(images.set(), 0b11);
  EXPECT_EQ(threads(), before + 1) << "the one that was asked for";
}

}  // namespace
}  // namespace waymark
