// Markers looked for where they are expected, against the whole image: what is found, and the
// processor time of one thread. Expected are those that the whole image shows, moved by up to
// OFFSET pixels (20), at random; windows reach as far and a margin beyond.
// Usage: bench_guided_detection [--offset PX] CAPTURE...

#include <fmt/core.h>

#include <algorithm>
#include <ctime>
#include <random>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "core/detect/expected_marker.h"
#include "core/detect/marker_detector.h"
#include "core/marker/marker_outline.h"

namespace {

using namespace waymark;  // NOLINT(google-build-using-namespace): a program of one file

double thread_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

struct Tally {
  std::vector<double> whole_ms;
  std::vector<double> guided_ms;
  int expected = 0;
  int found = 0;
  double largest_difference_px = 0;
};

bool is_among(const Detection& one, const std::vector<Detection>& found, Tally& tally) {
  for (const Detection& other : found) {
    if (other.marker != one.marker) continue;
    if ((centre_of(other.corners) - centre_of(one.corners)).norm() > 2) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      tally.largest_difference_px =
          std::max(tally.largest_difference_px, (other.corners[i] - one.corners[i]).norm());
    }
    return true;
  }
  return false;
}

void look(const GrayView& image, MarkerDetector& detector, double offset_px, std::mt19937& random,
          Tally& tally) {
  double begin = thread_seconds();
  const std::vector<Detection> all = detector.detect(image);
  tally.whole_ms.push_back(1e3 * (thread_seconds() - begin));
  if (all.empty()) return;
  std::uniform_real_distribution<double> offset(-offset_px, offset_px);
  std::vector<ImageWindow> windows;
  for (const Detection& one : all) {
    ExpectedMarker expected{one.marker, one.corners, offset_px};
    const Eigen::Vector2d moved(offset(random), offset(random));
    for (Eigen::Vector2d& corner : expected.corners) corner += moved;
    windows.push_back(window_of(expected));
  }
  begin = thread_seconds();
  const std::vector<Detection>& found = detector.detect(image, windows);
  tally.guided_ms.push_back(1e3 * (thread_seconds() - begin));
  for (const Detection& one : all) {
    ++tally.expected;
    tally.found += is_among(one, found, tally) ? 1 : 0;
  }
}

void bench(const std::string& path, double offset_px) {
  const auto capture = open_capture_folder(path);
  if (!capture) {
    fmt::print(stderr, "{}\n", capture.error().message);
    return;
  }
  std::vector<Family> families;
  for (const auto& entry : capture->catalog.entries()) families.push_back(entry.family);
  const auto detector = make_detector(families);
  std::mt19937 random(3);
  Tally tally;
  for (const ImageFile& file : capture->images) {
    const auto loaded = read_gray_image(file.path);
    if (loaded) look(loaded->image.view(), *detector, offset_px, random, tally);
  }
  if (tally.guided_ms.empty()) return;
  double sum_ms = 0;
  for (const double ms : tally.guided_ms) sum_ms += ms;
  fmt::print("| {} | {} | {:.1f} | {:.2f} | {:.2f} ({:.2f}) | {:.0f} | {} of {} | {:.2f} |\n", path,
             tally.guided_ms.size(),
             static_cast<double>(tally.expected) / static_cast<double>(tally.guided_ms.size()),
             median(tally.whole_ms), median(tally.guided_ms),
             *std::max_element(tally.guided_ms.begin(), tally.guided_ms.end()),
             1e3 * sum_ms / tally.expected, tally.found, tally.expected,
             tally.largest_difference_px);
}

}  // namespace

int main(int argc, char** argv) {
  double offset_px = 20;
  fmt::print(
      "| capture | images | markers each | whole, ms | guided, ms (max) | us a marker | found | "
      "corners differ, px |\n");
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--offset" && i + 1 < argc) {
      offset_px = std::stod(argv[++i]);
    } else {
      bench(argument, offset_px);
    }
  }
}
