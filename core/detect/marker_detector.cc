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

namespace waymark {
namespace {

bool in_order(const Detection& a, const Detection& b) {
  const auto key = [](const Detection& d) {
    return std::tuple(d.marker, d.corners[0].x(), d.corners[0].y());
  };
  return key(a) < key(b);
}

/// Several detectors as one.
class CombinedDetector final : public MarkerDetector {
 public:
  explicit CombinedDetector(std::vector<std::unique_ptr<MarkerDetector>> parts)
      : parts_(std::move(parts)) {}

  const std::vector<Detection>& find(const GrayView& image) override {
    all_.clear();
    for (const auto& part : parts_) {
      const std::vector<Detection>& found = part->detect(image);
      all_.insert(all_.end(), found.begin(), found.end());
      if (!part->failure().empty()) set_failure(part->failure());
    }
    std::sort(all_.begin(), all_.end(), in_order);
    return all_;
  }

 private:
  std::vector<std::unique_ptr<MarkerDetector>> parts_;
  std::vector<Detection> all_;
};

std::vector<Family> sorted_once(std::span<const Family> families) {
  std::vector<Family> sorted(families.begin(), families.end());
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

std::unique_ptr<MarkerDetector> make_part(DetectorEngine engine,
                                          const std::vector<Family>& families,
                                          const DetectorOptions& options) {
  if (engine == DetectorEngine::opencv) return std::make_unique<ArucoDetector>(families, options);
  return std::make_unique<ApriltagDetector>(families, options);
}

/// One detector of each engine that `engine_of` names for some family.
template <typename EngineOf>
std::unique_ptr<MarkerDetector> make_combined(std::span<const Family> families,
                                              const DetectorOptions& options,
                                              const EngineOf& engine_of) {
  WAYMARK_CHECK(!families.empty() && options.check().has_value());
  std::vector<std::unique_ptr<MarkerDetector>> parts;
  for (const DetectorEngine engine : {DetectorEngine::opencv, DetectorEngine::apriltag}) {
    std::vector<Family> own;
    for (const Family family : sorted_once(families)) {
      if (engine_of(family) == engine) own.push_back(family);
    }
    if (!own.empty()) parts.push_back(make_part(engine, own, options));
  }
  return std::make_unique<CombinedDetector>(std::move(parts));
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

bool engine_knows(DetectorEngine engine, Family family) {
  return engine == DetectorEngine::opencv || family >= Family::tag16h5;
}

DetectorEngine best_engine(Family) { return DetectorEngine::opencv; }

std::unique_ptr<MarkerDetector> make_detector(std::span<const Family> families,
                                              const DetectorOptions& options) {
  return make_combined(families, options, best_engine);
}

std::unique_ptr<MarkerDetector> make_detector(DetectorEngine engine,
                                              std::span<const Family> families,
                                              const DetectorOptions& options) {
  return make_combined(families, options, [&](Family family) {
    WAYMARK_CHECK(engine_knows(engine, family));
    return engine;
  });
}

}  // namespace waymark
