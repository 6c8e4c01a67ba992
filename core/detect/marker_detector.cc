#include "core/detect/marker_detector.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <opencv2/core/utility.hpp>
#include <tuple>
#include <utility>

#include "core/base/check.h"
#include "core/base/one_line.h"
#include "core/detect/apriltag_detector.h"
#include "core/detect/aruco_detector.h"
#include "core/detect/own_detector.h"

namespace waymark {
namespace {

bool in_order(const Detection& a, const Detection& b) {
  const auto key = [](const Detection& d) {
    return std::tuple(d.marker, d.corners[0].x(), d.corners[0].y());
  };
  return key(a) < key(b);
}

/// Puts what a detector finds in order.
class OrderedDetector final : public MarkerDetector {
 public:
  explicit OrderedDetector(std::unique_ptr<MarkerDetector> detector)
      : detector_(std::move(detector)) {}

  const std::vector<Detection>& find(const GrayView& image) override {
    const std::vector<Detection>& found = detector_->detect(image);
    ordered_.assign(found.begin(), found.end());
    if (!detector_->failure().empty()) set_failure(detector_->failure());
    std::sort(ordered_.begin(), ordered_.end(), in_order);
    return ordered_;
  }

 private:
  std::unique_ptr<MarkerDetector> detector_;
  std::vector<Detection> ordered_;
};

std::vector<Family> sorted_once(std::span<const Family> families) {
  std::vector<Family> sorted(families.begin(), families.end());
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

std::unique_ptr<MarkerDetector> make_unordered(const std::vector<Family>& families,
                                               const DetectorOptions& options) {
  switch (options.engine) {
    case DetectorEngine::own:
      return std::make_unique<OwnDetector>(families, options);
    case DetectorEngine::opencv:
      return std::make_unique<ArucoDetector>(families, options);
    case DetectorEngine::apriltag:
      break;
  }
  return std::make_unique<ApriltagDetector>(families, options);
}

}  // namespace

Status DetectorOptions::check() const {
  return RangeCheck().field("min_side_px", min_side_px, {8, 1000}).status();
}

const std::vector<Detection>& MarkerDetector::detect(const GrayView& image) noexcept {
  static const std::vector<Detection> nothing;
  failure_.clear();
  try {
    return find(image);
  } catch (const std::exception& error) {
    failure_ = in_one_line(error.what());
  } catch (...) {
    failure_ = "the detector's library failed";
  }
  return nothing;
}

void detect_in_calling_threads() {
  // OpenCV's setting is no atomic: it is made once, not again while detectors work.
  static std::once_flag once;
  std::call_once(once, [] { cv::setNumThreads(1); });
}

std::string_view name_of(DetectorEngine engine) {
  switch (engine) {
    case DetectorEngine::own:
      return "own";
    case DetectorEngine::opencv:
      return "opencv";
    case DetectorEngine::apriltag:
      break;
  }
  return "apriltag";
}

bool engine_knows(DetectorEngine engine, Family family) {
  return engine != DetectorEngine::apriltag || family >= Family::tag16h5;
}

std::unique_ptr<MarkerDetector> make_detector(std::span<const Family> families,
                                              const DetectorOptions& options) {
  WAYMARK_CHECK(!families.empty() && options.check().has_value());
  const std::vector<Family> sorted = sorted_once(families);
  for (const Family family : sorted) WAYMARK_CHECK(engine_knows(options.engine, family));
  return std::make_unique<OrderedDetector>(make_unordered(sorted, options));
}

}  // namespace waymark
