#include "mapbuilder/observations/detect_videos.h"

#include <atomic>
#include <memory>
#include <utility>

#include "core/base/parallel.h"
#include "core/camera/kalibr.h"
#include "core/geometry/tum.h"

namespace waymark {
namespace {

/// Up to `count` frames; fewer at the end.
Expected<std::vector<VideoFrame>> take_frames(VideoSource& source, std::size_t count) {
  std::vector<VideoFrame> frames;
  while (frames.size() < count) {
    auto frame = source.next();
    if (!frame) return tl::make_unexpected(frame.error());
    if (!*frame) break;
    frames.push_back(std::move(**frame));
  }
  return frames;
}

/// What a video's first frame was held against holds for all of them: some change on the way.
Status check_sizes(const std::vector<VideoFrame>& frames,
                   const std::vector<std::filesystem::path>& videos, const Rig& rig) {
  for (const VideoFrame& frame : frames) {
    const auto camera = static_cast<std::size_t>(frame.camera);
    const CameraParameters& expected = rig.cameras[camera].model.parameters();
    const GrayImage& image = frame.image;
    if (image.width_px == expected.width_px && image.height_px == expected.height_px) continue;
    return fail(ErrorKind::bad_data,
                "{}: the frame at {} s is {}×{}, the rig says {}×{}; cut the video where its size "
                "changes",
                videos[camera].string(), format_stamp_s(frame.stamp), image.width_px,
                image.height_px, expected.width_px, expected.height_px);
  }
  return {};
}

}  // namespace

Expected<DetectedCapture> detect_videos(const VideoCapture& capture,
                                        const DetectCaptureOptions& options, Progress& progress,
                                        DetectionReport& report) {
  auto loaded = read_camchain(capture.rig_yaml);
  if (!loaded) return tl::make_unexpected(loaded.error());
  report.warnings = std::move(loaded->notes);
  auto catalog = read_marker_catalog(capture.markers_toml);
  if (!catalog) return tl::make_unexpected(catalog.error());
  auto detectors = image_detectors(*catalog, options.engine, effective_threads(options.threads),
                                   capture.markers_toml.string());
  if (!detectors) return tl::make_unexpected(detectors.error());
  auto source = open_videos(capture.videos, loaded->rig, capture.options);
  if (!source) return tl::make_unexpected(source.error());

  DetectedCapture detected;
  detected.name = capture.videos.front().string();
  detected.rig = std::move(loaded->rig);
  detected.catalog = std::move(*catalog);
  progress.begin("detecting markers", (*source)->expected_frames());
  for (;;) {
    // A batch at a time: memory holds no more frames than the threads keep busy with.
    const auto frames = take_frames(**source, detectors->size() * 4);
    if (!frames) return tl::make_unexpected(frames.error());
    if (frames->empty()) break;
    if (auto sized = check_sizes(*frames, capture.videos, detected.rig); !sized) {
      return tl::make_unexpected(sized.error());
    }
    std::vector<FoundMarkers> found(frames->size());
    std::atomic<std::size_t> next_detector{0};
    parallel_for_with(
        frames->size(), static_cast<int>(detectors->size()),
        [&] { return (*detectors)[next_detector.fetch_add(1)].get(); },
        [&](ImageDetector* detector, std::size_t i) {
          const VideoFrame& frame = (*frames)[i];
          const auto camera = static_cast<std::size_t>(frame.camera);
          const RigCamera& by = detected.rig.cameras[camera];
          found[i] =
              detector->detect(frame.image.view(), by.model, {}, by.edge_bias_px.value_or(0));
        });
    for (std::size_t i = 0; i < frames->size(); ++i) {
      const VideoFrame& frame = (*frames)[i];
      report.counts += found[i].counts;
      report.detections += found[i].detections.size();
      detected.images.push_back({frame.stamp, frame.camera, std::move(found[i].detections)});
    }
    report.images = detected.images.size();
    progress.update(report.images, fmt::format("{} markers", report.detections));
  }
  progress.end();
  report.warnings.insert(report.warnings.end(), (*source)->notes().begin(),
                         (*source)->notes().end());
  fit_sync_tolerance(detected, report);
  return detected;
}

}  // namespace waymark
