#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "core/capture/pgm.h"
#include "drivers/monotonic_clock.h"
#include "locd/record/recording_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark::test {

inline constexpr Stamp kStart = std::chrono::seconds(1'800'000'000);

inline RecordingFacts facts() {
  RecordingFacts f;
  f.rig_yaml = tiny_rig_yaml(2);
  f.markers_toml = tiny_markers_toml();
  f.session_id = "0123456789abcdef";
  f.version = "0.1.0";
  f.codec = "pgm";
  f.cameras = {"cam0", "cam1"};
  f.sync_tolerance = std::chrono::milliseconds(5);
  f.date_known = true;
  return f;
}

inline RecordingBudget generous() { return {std::uint64_t{1} << 40, std::chrono::hours(100), 0}; }

inline const std::string& image_bytes() {
  static const std::string bytes = encode_pgm(GrayImage(64, 48, 7).view());
  return bytes;
}

/// What a set takes on the disk: whole blocks.
inline std::uint64_t set_bytes() {
  constexpr std::uint64_t kBlock = 4096;
  return 2 * ((image_bytes().size() + kBlock - 1) / kBlock * kBlock);
}

/// What this many sets, at most ten, take with their table; less than one more would.
inline std::uint64_t bytes_of(std::uint64_t sets) {
  constexpr std::uint64_t kTable = 3000;
  return sets * set_bytes() + kTable;
}

inline std::vector<RecordedImage> set_at(Stamp stamp) {
  std::vector<RecordedImage> images(2);
  for (std::size_t c = 0; c < 2; ++c) {
    images[c].camera = c;
    images[c].info.stamp = stamp + std::chrono::microseconds(c);
    images[c].info.sequence = 42;
    images[c].info.exposure = std::chrono::microseconds(250);
    images[c].bytes = image_bytes();
  }
  return images;
}

/// Waits until the folder knows what was there before; false when it takes longer than any disk.
inline bool know(RecordingFolder& folder) {
  const Stamp deadline = monotonic_now() + std::chrono::seconds(20);
  while (!folder.knows_what_was_there()) {
    if (monotonic_now() > deadline) return false;
    std::this_thread::yield();
  }
  return true;
}

/// One that knows what was there before.
inline Expected<RecordingFolder> open_folder(const std::filesystem::path& path,
                                             const RecordingFacts& facts,
                                             const RecordingBudget& budget) {
  auto folder = RecordingFolder::open(path, facts, budget);
  EXPECT_TRUE(!folder || know(*folder));
  return folder;
}

/// Whether a set is written, now.
inline bool writes(RecordingFolder& folder, Stamp stamp) {
  const auto written = folder.write_set(set_at(stamp));
  EXPECT_TRUE(written) << written.error().message;
  return written && *written;
}

/// Images in the capture as its readers see it.
inline std::size_t images_in(const std::filesystem::path& path) {
  const auto capture = open_capture_folder(path);
  EXPECT_TRUE(capture) << capture.error().message;
  if (!capture) return 0;
  for (const ImageFile& file : capture->images) EXPECT_TRUE(read_gray_image(file.path));
  return capture->images.size();
}

}  // namespace waymark::test
