#include "core/detect/marker_detector.h"

#include <algorithm>
#include <exception>
#include <tuple>

#include "core/base/check.h"
#include "core/base/one_line.h"
#include "core/detect/own_detector.h"

namespace waymark {
namespace {

bool in_order(const Detection& a, const Detection& b) {
  const auto key = [](const Detection& d) {
    return std::tuple(d.marker, d.corners[0].x(), d.corners[0].y());
  };
  return key(a) < key(b);
}

}  // namespace

Status DetectorOptions::check() const {
  return RangeCheck().field("min_side_px", min_side_px, {8, 1000}).status();
}

const std::vector<Detection>& MarkerDetector::detect(
    const GrayView& image, std::span<const ImageWindow> windows) noexcept {
  ordered_.clear();
  failure_.clear();
  try {
    const std::vector<Detection>& found = find(image, windows);
    ordered_.assign(found.begin(), found.end());
    std::sort(ordered_.begin(), ordered_.end(), in_order);
  } catch (const std::exception& error) {
    failure_ = in_one_line(error.what());
  } catch (...) {
    failure_ = "the detector's library failed";
  }
  return ordered_;
}

std::unique_ptr<MarkerDetector> make_detector(std::span<const Family> families,
                                              const DetectorOptions& options) {
  WAYMARK_CHECK(!families.empty() && options.check().has_value());
  std::vector<Family> sorted(families.begin(), families.end());
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return std::make_unique<OwnDetector>(sorted, options);
}

}  // namespace waymark
