// The detectors side by side: share of rendered markers found, false ids, time per image.
// Usage: bench_detect_engines [CAPTURE...]: also counts detections on the captures' photos.

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <opencv2/core/utility.hpp>
#include <random>
#include <set>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "core/detect/image_detector.h"
#include "core/detect/marker_detector.h"
#include "tests/support/marker_renderer.h"

namespace {

using namespace waymark;  // NOLINT(google-build-using-namespace): a program of one file
using waymark::testing::MarkerView;
using waymark::testing::RenderedMarker;

constexpr DetectorEngine kEngines[]{DetectorEngine::opencv, DetectorEngine::apriltag};

const char* name_of_engine(DetectorEngine engine) {
  return engine == DetectorEngine::opencv ? "opencv" : "apriltag";
}

struct Tally {
  int shown = 0;
  int found = 0;
  int wrong = 0;
  int images = 0;
  double seconds = 0;
};

std::vector<Detection> timed_detect(MarkerDetector& detector, const GrayView& image, Tally& tally) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Detection> found = detector.detect(image);
  tally.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ++tally.images;
  return found;
}

/// Twelve markers per image at random.
Tally rendered(DetectorEngine engine, Family family, double side_px, double tilt_deg) {
  const CameraModel camera = *CameraModel::create({1280, 960, 1000, 1000, 639.5, 479.5});
  const auto detector = make_detector(engine, {&family, 1});
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> unit(0, 1);
  Tally tally;
  for (int i = 0; i < 4; ++i) {
    std::vector<RenderedMarker> markers;
    std::set<int> shown;
    for (int k = 0; k < 12; ++k) {
      RenderedMarker marker;
      marker.id = {family, static_cast<int>(unit(generator) * traits(family).id_count)};
      const int row = k / 4;
      const MarkerView view{{160.0 + 320 * (k % 4), 160.0 + 320 * row},
                            side_px,
                            tilt_deg * std::numbers::pi / 180,
                            6.28 * unit(generator),
                            6.28 * unit(generator)};
      marker.cam_from_marker = pose_seen_as(camera, view, marker.size_m);
      markers.push_back(marker);
      shown.insert(marker.id.number);
    }
    testing::RenderOptions options;
    options.seed = static_cast<std::uint64_t>(i) + 1;
    const GrayImage image = testing::render_markers(camera, markers, options);
    std::set<int> found;
    for (const Detection& detection : timed_detect(*detector, image.view(), tally)) {
      if (shown.contains(detection.marker.number)) {
        found.insert(detection.marker.number);
      } else {
        ++tally.wrong;
      }
    }
    tally.shown += static_cast<int>(shown.size());
    tally.found += static_cast<int>(found.size());
  }
  return tally;
}

void print_rendered() {
  fmt::print("Rendered, 12 markers in 1280×960, PSF σ 0.8 px, noise 2: found % (false ids) ms\n");
  for (const Family family : {Family::aruco_4x4_1000, Family::aruco_original, Family::tag16h5,
                              Family::tag25h9, Family::tag36h11}) {
    for (const DetectorEngine engine : kEngines) {
      if (!engine_knows(engine, family)) continue;
      fmt::print("| {:<14} | {:<8} |", name_of(family), name_of_engine(engine));
      for (const double side_px : {14.0, 18.0, 24.0, 60.0}) {
        for (const double tilt_deg : {0.0, 60.0}) {
          const Tally tally = rendered(engine, family, side_px, tilt_deg);
          fmt::print(" {:.0f}px {:.0f}°: {:.0f} ({}) {:.0f} |", side_px, tilt_deg,
                     100.0 * tally.found / tally.shown, tally.wrong,
                     1e3 * tally.seconds / tally.images);
        }
      }
      fmt::print("\n");
    }
  }
}

void print_capture(const std::string& path) {
  const auto capture = open_capture_folder(path);
  if (!capture) {
    fmt::print(stderr, "{}\n", capture.error().message);
    return;
  }
  std::vector<GrayImage> images;
  for (const ImageFile& file : capture->images) {
    auto loaded = read_gray_image(file.path);
    if (loaded) images.push_back(std::move(loaded->image));
  }
  const Family family = capture->catalog.entries().front().family;
  for (const DetectorEngine engine : kEngines) {
    if (!engine_knows(engine, family)) continue;
    const auto detector = make_detector(engine, {&family, 1});
    Tally tally;
    std::set<int> ids;
    for (const GrayImage& image : images) {
      for (const Detection& detection : timed_detect(*detector, image.view(), tally)) {
        ++tally.found;
        ids.insert(detection.marker.number);
      }
    }
    fmt::print("| {} | {} | {} detections, {} ids | {:.0f} ms per image |\n", path,
               name_of_engine(engine), tally.found, ids.size(), 1e3 * tally.seconds / tally.images);
  }
  ImageDetector detector(capture->catalog);
  DetectionCounts counts;
  const CameraModel& camera = capture->rig.cameras.front().model;
  for (const GrayImage& image : images) counts += detector.detect(image.view(), camera).counts;
  fmt::print(
      "| {} | refined | found {} unknown {} unrefined {} misread {} ambiguous {} kept {} |\n", path,
      counts.found, counts.unknown, counts.unrefined, counts.misread, counts.ambiguous,
      counts.kept);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  print_rendered();
  for (int i = 1; i < argc; ++i) print_capture(argv[i]);
}
