#include "mapbuilder/observations/detect_capture.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>

#include "core/base/parallel.h"
#include "core/capture/detections_csv.h"
#include "core/capture/edge_moves.h"
#include "core/capture/image_file.h"
#include "core/capture/sync_tolerance.h"
#include "mapbuilder/observations/edge_correction.h"

namespace waymark {
namespace {

/// Of which corners compare: another is stale.
constexpr std::string_view kDetector = "waymark-2";

/// One image's outcome.
struct DetectedImage {
  std::optional<FoundMarkers> found;
  std::optional<Error> why_not;
  bool orientation_ignored = false;
  std::optional<DeepPixels> deep;
};

DetectedImage detect_image(const ImageFile& file, const RigCamera& camera,
                           ImageDetector& detector) {
  DetectedImage result;
  const CameraParameters& expected = camera.model.parameters();
  auto loaded = read_gray_image(file.path, ImageSize{expected.width_px, expected.height_px});
  if (!loaded) {
    result.why_not = std::move(loaded.error());
    return result;
  }
  const GrayImage& image = loaded->image;
  result.orientation_ignored = loaded->orientation_ignored;
  result.deep = loaded->deep;
  const FoundMarkers& found =
      detector.detect(image.view(), camera.model, {}, camera.edge_bias_px.value_or(0));
  if (!found.failure.empty()) {
    result.why_not = Error{ErrorKind::bad_data, fmt::format("{}: can't be searched for markers: {}",
                                                            file.path.string(), found.failure)};
    return result;
  }
  result.found = found;
  return result;
}

/// What the images with 16 bits per value have in common.
class DeepImages {
 public:
  void add(const DeepPixels& deep) {
    ++images_;
    largest_ = std::max(largest_, deep.largest);
    fewest_bits_ = std::min(fewest_bits_, deep.bits_in_use);
    most_bits_ = std::max(most_bits_, deep.bits_in_use);
  }

  [[nodiscard]] std::optional<std::string> note() const {
    if (images_ == 0) return std::nullopt;
    if (fewest_bits_ == 16)
      return fmt::format("{} images have 16 bits; the upper 8 are used", images_);
    const std::string bits = fewest_bits_ == most_bits_
                                 ? fmt::format("{}", most_bits_)
                                 : fmt::format("{} to {}", fewest_bits_, most_bits_);
    return fmt::format(
        "{} images have 16 bits, the largest value is {} of 65535: {} bits in the low end, and "
        "read "
        "so",
        images_, largest_, bits);
  }

 private:
  std::size_t images_ = 0;
  int largest_ = 0;
  int fewest_bits_ = 16;
  int most_bits_ = 0;
};

Expected<DetectedCapture> from_images(const CaptureFolder& capture,
                                      const DetectCaptureOptions& options, Progress& progress,
                                      DetectionReport& report) {
  const int threads = effective_threads(options.threads);
  auto detectors = image_detectors(capture.catalog, options.engine, threads, capture.path.string());
  if (!detectors) return tl::make_unexpected(detectors.error());
  DetectedCapture detected{capture.path.string(),  capture.rig,      capture.catalog, {},
                           capture.sync_tolerance, capture.monotonic};
  std::size_t rotated = 0;
  DeepImages deep;
  std::optional<Error> first_error;
  // A batch at a time, so that progress can be shown from this thread.
  const std::size_t batch = static_cast<std::size_t>(threads) * 4;
  progress.begin("detecting markers", capture.images.size());
  for (std::size_t first = 0; first < capture.images.size(); first += batch) {
    const std::size_t count = std::min(batch, capture.images.size() - first);
    std::vector<DetectedImage> results(count);
    std::atomic<std::size_t> next_detector{0};
    parallel_for_with(
        count, threads, [&] { return (*detectors)[next_detector.fetch_add(1)].get(); },
        [&](ImageDetector* detector, std::size_t i) {
          const ImageFile& file = capture.images[first + i];
          const auto camera = static_cast<std::size_t>(file.camera);
          results[i] = detect_image(file, capture.rig.cameras[camera], *detector);
        });
    for (std::size_t i = 0; i < count; ++i) {
      const ImageFile& file = capture.images[first + i];
      ++report.images;
      if (!results[i].found) {
        ++report.unreadable;
        const Error& why = *results[i].why_not;
        report.warnings.push_back(why.message + "; skipped");
        if (!first_error) first_error = why;
        continue;
      }
      rotated += results[i].orientation_ignored ? 1 : 0;
      if (results[i].deep) deep.add(*results[i].deep);
      report.counts += results[i].found->counts;
      report.detections += results[i].found->detections.size();
      detected.images.push_back({file.stamp, file.camera, std::move(results[i].found->detections)});
    }
    progress.update(first + count, fmt::format("{} markers", report.detections));
  }
  progress.end();
  if (rotated > 0) {
    report.warnings.push_back(fmt::format(
        "{}: {} images ask for a rotation by EXIF; ignored, pixels are used as they are stored",
        detected.name, rotated));
  }
  if (const auto note = deep.note()) {
    report.warnings.push_back(fmt::format("{}: {}", detected.name, *note));
  }
  if (detected.images.empty()) {
    Error none{ErrorKind::bad_data,
               fmt::format("{}: none of {} images could be used; the first: {}", detected.name,
                           report.images, first_error ? first_error->message : "there is none")};
    if (first_error) none.cause = first_error->cause;
    return tl::make_unexpected(std::move(none));
  }
  return detected;
}

Expected<DetectedCapture> from_csv(const CaptureFolder& capture, DetectionReport& report) {
  auto table =
      read_detections_csv(*capture.detections_csv, capture.rig, capture.catalog, capture.monotonic);
  if (!table) return tl::make_unexpected(table.error());
  const bool ours = table->detector.rfind("waymark-", 0) == 0;
  if (ours && table->detector.rfind(kDetector, 0) != 0) {
    return fail(ErrorKind::bad_data,
                "{}: made by {}, this is {}: stale; run mapbuilder detect again, or remove it",
                capture.detections_csv->string(), table->detector, kDetector);
  }
  report.from_csv = true;
  report.images = table->images.size();
  for (const ImageDetections& image : table->images) report.detections += image.detections.size();
  if (table->unknown_markers > 0) {
    report.warnings.push_back(
        fmt::format("{}: {} rows left out, markers.toml ignores or lacks their ids",
                    capture.detections_csv->string(), table->unknown_markers));
  }
  if (table->misordered > 0) {
    report.warnings.push_back(
        fmt::format("{}: {} rows left out, their corners do not run clockwise from top-left",
                    capture.detections_csv->string(), table->misordered));
  }
  DetectedCapture detected{capture.path.string(),  capture.rig,
                           capture.catalog,        std::move(table->images),
                           capture.sync_tolerance, capture.monotonic};
  detected.unlisted = std::move(table->unlisted);
  for (const auto& move : table->moves) {
    detected.edges.push_back(move ? move->measured : std::nullopt);
  }
  if (const auto unsure = widen_for_unknown_moves(*table, detected.rig); !unsure.empty()) {
    report.warnings.push_back(fmt::format(
        "{}: does not say by how much corners of {} were moved for the edge_bias_px of rig.yaml; "
        "they count as unsure by all of it. Detect again (--redetect)",
        capture.detections_csv->string(), fmt::join(unsure, ", ")));
  }
  return detected;
}

}  // namespace

std::string detector_name(DetectorEngine engine) {
  return fmt::format("{}-{}", kDetector, name_of(engine));
}

void fit_sync_tolerance(DetectedCapture& capture, DetectionReport& report) {
  std::vector<StampedImage> images;
  images.reserve(capture.images.size());
  for (const ImageDetections& image : capture.images) images.push_back({image.camera, image.stamp});
  auto usable = usable_tolerance(capture.sync_tolerance, images, capture.rig.cameras.size());
  capture.sync_tolerance = usable.tolerance;
  if (!usable.note) return;
  // First: of very many only the first are shown.
  report.warnings.insert(report.warnings.begin(),
                         fmt::format("{}: {}", capture.name, *usable.note));
}

Expected<std::vector<std::unique_ptr<ImageDetector>>> image_detectors(const MarkerCatalog& catalog,
                                                                      DetectorEngine engine,
                                                                      int count,
                                                                      const std::string& name) {
  std::vector<std::unique_ptr<ImageDetector>> detectors;
  for (int i = 0; i < count; ++i) {
    auto detector = make_detector(engine, catalog, name);
    if (!detector) return tl::make_unexpected(detector.error());
    detectors.push_back(std::make_unique<ImageDetector>(catalog, std::move(*detector)));
  }
  return detectors;
}

Expected<DetectedCapture> detect_capture(const CaptureFolder& capture,
                                         const DetectCaptureOptions& options, Progress& progress,
                                         DetectionReport& report) {
  const bool by_csv = capture.detections_csv && !options.redetect;
  auto detected =
      by_csv ? from_csv(capture, report) : from_images(capture, options, progress, report);
  if (detected) fit_sync_tolerance(*detected, report);
  if (detected && !by_csv && options.correct_edges) {
    report.edges = correct_edges(capture, *detected, options.threads, progress);
  }
  return detected;
}

}  // namespace waymark
