#include "locd/record/recorder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <functional>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "drivers/monotonic_clock.h"
#include "tests/support/disk_double.h"
#include "tests/support/expect_ranges.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

constexpr Stamp kStart = std::chrono::seconds(1000);
constexpr Stamp kWall = std::chrono::seconds(1'800'000'000);

RecordingFacts facts(const char* codec) {
  RecordingFacts f;
  f.rig_yaml = tiny_rig_yaml(2);
  f.markers_toml = tiny_markers_toml();
  f.session_id = "0123456789abcdef";
  f.version = "0.1.0";
  f.codec = codec;
  f.cameras = {"cam0", "cam1"};
  return f;
}

RecorderOptions options() {
  RecorderOptions o;
  o.budget.min_free_bytes = 0;
  o.pixels = {std::size_t{64} * 48, std::size_t{64} * 48};
  return o;
}

/// Images of two cameras whose every pixel tells camera and set; rows have padding, as buffers of
/// devices do.
class TwoCameras {
 public:
  FrameSetLease set(int index) {
    FrameSetLease lease;
    lease.expected = 0b11;
    lease.cameras = 0b11;
    for (std::size_t c = 0; c < 2; ++c) {
      pixels_[c].assign(std::size_t{80} * 48,
                        static_cast<std::uint8_t>(10 * index + static_cast<int>(c)));
      FrameInfo info;
      info.stamp = kStart + std::chrono::seconds(index);
      lease.frames[c] = Frame(info, {pixels_[c].data(), 64, 48, 80}, nullptr, nullptr, 0);
    }
    return lease;
  }

 private:
  std::array<std::vector<std::uint8_t>, 2> pixels_;
};

/// Waits for the recorder's thread; false when it takes longer than any machine needs.
bool eventually(const std::function<bool()>& holds) {
  const Stamp deadline = monotonic_now() + std::chrono::seconds(20);
  while (!holds()) {
    if (monotonic_now() > deadline) return false;
    std::this_thread::yield();
  }
  return true;
}

/// How the recording began.
Status begin(Recorder& recorder, const std::filesystem::path& folder, const RecordingFacts& facts,
             const RecorderOptions& options) {
  recorder.start(folder, facts, options);
  EXPECT_TRUE(recorder.settle(monotonic_now() + std::chrono::seconds(20)));
  const auto failure = recorder.state().failure;
  return failure ? tl::make_unexpected(*failure) : Status{};
}

void end(Recorder& recorder) {
  recorder.stop();
  EXPECT_TRUE(recorder.settle(monotonic_now() + std::chrono::seconds(20)));
}

/// Offers one set after the other, each as soon as the one before is on disk.
void record(Recorder& recorder, int sets) {
  TwoCameras cameras;
  for (int i = 0; i < sets; ++i) {
    const std::uint64_t before = recorder.state().sets;
    recorder.offer(cameras.set(i), kWall);
    ASSERT_TRUE(
        eventually([&] { return recorder.state().sets > before || !recorder.state().running(); }));
  }
}

TEST(Recorder, RecordsThePixelsAndStampsOfASet) {
  const TemporaryFolder tmp;
  Recorder recorder;
  ASSERT_TRUE(begin(recorder, tmp.path(), facts("pgm"), options()));
  record(recorder, 5);
  end(recorder);
  const auto capture = open_capture_folder(tmp.path());
  ASSERT_TRUE(capture) << capture.error().message;
  ASSERT_EQ(capture->images.size(), 10U);
  for (const ImageFile& file : capture->images) {
    const auto image = read_gray_image(file.path);
    ASSERT_TRUE(image);
    const auto index = (file.stamp - kStart - kWall) / std::chrono::seconds(1);
    EXPECT_EQ(file.stamp, kStart + kWall + std::chrono::seconds(index));
    EXPECT_EQ(image->image.pixels,
              std::vector<std::uint8_t>(std::size_t{64} * 48,
                                        static_cast<std::uint8_t>(10 * index + file.camera)));
  }
  EXPECT_FALSE(recorder.state().running());
  EXPECT_FALSE(recorder.state().failure);
}

TEST(Recorder, JpegIsACaptureToo) {
  const TemporaryFolder tmp;
  Recorder recorder;
  RecorderOptions chosen = options();
  chosen.jpeg = true;
  ASSERT_TRUE(begin(recorder, tmp.path(), facts("jpeg"), chosen));
  record(recorder, 2);
  end(recorder);
  const auto capture = open_capture_folder(tmp.path());
  ASSERT_TRUE(capture) << capture.error().message;
  ASSERT_EQ(capture->images.size(), 4U);
  EXPECT_EQ(capture->images[0].path.extension(), ".jpg");
  EXPECT_NEAR(read_gray_image(capture->images[3].path)->image.pixels[0], 11, 1);
}

TEST(Recorder, WhatNobodyRecordsCostsNothing) {
  Recorder recorder;
  TwoCameras cameras;
  recorder.offer(cameras.set(0), kWall);
  EXPECT_EQ(recorder.state().drops, 0U);
}

TEST(Recorder, NeverWaitsForASlowDisk) {
  const TemporaryFolder tmp;
  Recorder recorder;
  ASSERT_TRUE(begin(recorder, tmp.path(), facts("pgm"), options()));
  TwoCameras cameras;
  constexpr int kSets = 2000;
  for (int i = 0; i < kSets; ++i)
    recorder.offer(cameras.set(i % 20), kWall);  // faster than any disk
  end(recorder);
  const auto state = recorder.state();
  EXPECT_GT(state.drops, 0U);
  EXPECT_LE(state.drops, kSets - Recorder::kSlots);
}

TEST(Recorder, EveryNthSetIsTaken) {
  const TemporaryFolder tmp;
  Recorder recorder;
  RecorderOptions chosen = options();
  chosen.every_nth = 3;
  ASSERT_TRUE(begin(recorder, tmp.path(), facts("pgm"), chosen));
  TwoCameras cameras;
  for (int i = 0; i < 9; ++i) {
    recorder.offer(cameras.set(i), kWall);
    ASSERT_TRUE(
        eventually([&] { return recorder.state().sets == static_cast<std::uint64_t>(i / 3 + 1); }));
  }
  end(recorder);
  EXPECT_EQ(open_capture_folder(tmp.path())->images.size(), 6U);
}

TEST(Recorder, AFailureEndsTheRecordingAndIsSaid) {
  const TemporaryFolder tmp;
  Recorder recorder;
  RecorderOptions chosen = options();
  chosen.budget.min_free_bytes = std::uint64_t{1} << 60;
  ASSERT_TRUE(begin(recorder, tmp.path(), facts("pgm"), chosen));
  TwoCameras cameras;
  // The archive is weighed beside: sets come on until that is done.
  int next = 0;
  ASSERT_TRUE(eventually([&] {
    recorder.offer(cameras.set(next++), kWall);
    return !recorder.state().running();
  }));
  ASSERT_TRUE(recorder.state().failure);
  for (int i = 0; i < 100; ++i) recorder.offer(cameras.set(i), kWall);  // no effect, no wait
  EXPECT_FALSE(recorder.state().running());
  const TemporaryFolder other;
  ASSERT_TRUE(begin(recorder, other.path(), facts("pgm"), options()));
  record(recorder, 1);
  EXPECT_EQ(recorder.state().sets, 1U);
  EXPECT_FALSE(recorder.state().failure);
}

TEST(Recorder, ADiskThatStallsHoldsUpNobody) {
  const TemporaryFolder tmp;
  test::DiskDouble disk;
  Recorder recorder;
  disk.stall();
  recorder.start(tmp.path() / "a", facts("pgm"), options());
  ASSERT_TRUE(disk.holds_somebody(monotonic_now() + std::chrono::seconds(20)));
  EXPECT_EQ(recorder.state().phase, Recorder::Phase::starting);
  EXPECT_FALSE(recorder.settle(monotonic_now()));
  disk.release();
  ASSERT_TRUE(recorder.settle(monotonic_now() + std::chrono::seconds(20)));
  ASSERT_EQ(recorder.state().phase, Recorder::Phase::recording);
  disk.stall();
  TwoCameras cameras;
  for (int i = 0; i < 100; ++i) recorder.offer(cameras.set(i % 20), kWall);
  recorder.stop();
  ASSERT_TRUE(disk.holds_somebody(monotonic_now() + std::chrono::seconds(20)));
  EXPECT_EQ(recorder.state().phase, Recorder::Phase::stopping);
  disk.release();
  ASSERT_TRUE(recorder.settle(monotonic_now() + std::chrono::seconds(20)));
  EXPECT_EQ(open_capture_folder(tmp.path() / "a")->images.size(),
            2 * (100 - recorder.state().drops));
}

TEST(Recorder, ARecordingThatIsStoppedBeforeItBeganIsNone) {
  const TemporaryFolder tmp;
  test::DiskDouble disk;
  Recorder recorder;
  disk.stall();
  recorder.start(tmp.path(), facts("pgm"), options());
  ASSERT_TRUE(disk.holds_somebody(monotonic_now() + std::chrono::seconds(20)));
  recorder.stop();
  TwoCameras cameras;
  recorder.offer(cameras.set(0), kWall);
  disk.release();
  ASSERT_TRUE(recorder.settle(monotonic_now() + std::chrono::seconds(20)));
  EXPECT_EQ(recorder.state().phase, Recorder::Phase::idle);
  EXPECT_EQ(recorder.state().sets, 0U);
  EXPECT_FALSE(recorder.state().failure);
}

/// Pages that this thread has touched for the first time since it began.
long faults() {
  rusage used{};
  ::getrusage(RUSAGE_THREAD, &used);
  return used.ru_minflt;
}

TEST(Recorder, TheFirstSetsFindTheirMemoryThere) {
  constexpr int kSide_px = 1024;
  constexpr long kPages = long{kSide_px} * kSide_px / 4096;
  const TemporaryFolder tmp;
  Recorder recorder;
  RecorderOptions chosen = options();
  chosen.pixels = {std::size_t{kSide_px} * kSide_px, std::size_t{kSide_px} * kSide_px};
  ASSERT_TRUE(begin(recorder, tmp.path(), facts("pgm"), chosen));
  const std::vector<std::uint8_t> pixels(std::size_t{kSide_px} * kSide_px, 7);
  FrameSetLease lease;
  lease.expected = lease.cameras = 0b11;
  for (std::size_t c = 0; c < 2; ++c) {
    FrameInfo info;
    info.stamp = kStart;
    lease.frames[c] =
        Frame(info, {pixels.data(), kSide_px, kSide_px, kSide_px}, nullptr, nullptr, 0);
  }
  const long before = faults();
  recorder.offer(lease, kWall);
  EXPECT_LT(faults() - before, kPages / 10);
  end(recorder);
  EXPECT_EQ(recorder.state().sets, 1U);
}

TEST(Recorder, ABudgetHoldsFromTheNextSetOn) {
  const TemporaryFolder tmp;
  Recorder recorder;
  ASSERT_TRUE(begin(recorder, tmp.path(), facts("pgm"), options()));
  record(recorder, 5);  // a second apart
  EXPECT_EQ(recorder.state().sets, 5U);
  RecordingBudget budget = options().budget;
  budget.keep = std::chrono::seconds(2);
  recorder.set_budget(budget);
  TwoCameras cameras;
  recorder.offer(cameras.set(5), kWall);
  EXPECT_TRUE(eventually([&] { return recorder.state().sets == 4; }));  // of 2 … 5: no two more go
  recorder.offer(cameras.set(6), kWall);
  EXPECT_TRUE(eventually([&] { return recorder.state().sets == 3; }));  // of 4, 5 and 6
  end(recorder);
}

TEST(Recorder, StartsAndStopsWhileSetsAreOffered) {
  const TemporaryFolder tmp;
  Recorder recorder;
  std::atomic<bool> done{false};
  std::thread cameras_thread([&] {
    TwoCameras cameras;
    for (int i = 0; !done; i = (i + 1) % 20) recorder.offer(cameras.set(i), kWall);
  });
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(begin(recorder, tmp.path() / std::to_string(i), facts("pgm"), options()));
    EXPECT_TRUE(eventually([&] { return recorder.state().sets > 0; }));
    end(recorder);
  }
  done = true;
  cameras_thread.join();
}

TEST(RecorderOptions, AreHeldToTheirRanges) {
  expect_ranges<RecorderOptions>(
      {ranged("jpeg_quality", &RecorderOptions::jpeg_quality, RecorderOptions::kJpegQuality),
       ranged("every_nth", &RecorderOptions::every_nth, RecorderOptions::kEveryNth)});
}

}  // namespace
}  // namespace waymark
