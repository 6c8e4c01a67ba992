#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/range.h"
#include "core/capture/detection.h"
#include "core/capture/gray_image.h"
#include "core/marker/family.h"

namespace waymark {

/// Finds and decodes markers: the seam behind which our own detector stands, and OpenCV's and
/// libapriltag's as referees.
/// Corners are rough (about ±1 px), in the order and pixel convention of `ImageCorners`
/// (pixel centre at integers); refine_corners makes them exact. One detector per thread.
class MarkerDetector {
 public:
  MarkerDetector() = default;
  MarkerDetector(const MarkerDetector&) = delete;
  MarkerDetector& operator=(const MarkerDetector&) = delete;
  virtual ~MarkerDetector() = default;

  /// All markers of the detector's families, by rising (id, first corner); no covariances yet. The
  /// same id may appear twice. Same image, same result, whatever the number of OpenCV's threads.
  /// The result is the detector's own, valid until the next call. Nothing is found where the
  /// library behind it fails; `failure` says why. Never throws.
  [[nodiscard]] const std::vector<Detection>& detect(const GrayView& image) noexcept;

  /// Why the last image could not be searched; empty as a rule.
  [[nodiscard]] const std::string& failure() const { return failure_; }

 protected:
  /// The same, which may throw what the library throws.
  [[nodiscard]] virtual const std::vector<Detection>& find(const GrayView& image) = 0;

  void set_failure(const std::string& why) { failure_ = why; }

 private:
  std::string failure_;
};

/// Who finds and decodes.
enum class DetectorEngine {
  own,       ///< OwnDetector: every family
  opencv,    ///< every family
  apriltag,  ///< libapriltag: the tag* families only
};

/// As `--detector` has them: own, opencv, apriltag.
[[nodiscard]] std::string_view name_of(DetectorEngine engine);

/// Whether the engine decodes the family.
[[nodiscard]] bool engine_knows(DetectorEngine engine, Family family);

/// The best by measurement: as much found as by any other in every bin of size and tilt but for one
/// marker, in a ninth to a sixtieth of the time (bench_detect_engines; bench/results.md).
inline constexpr DetectorEngine kBestEngine = DetectorEngine::own;

/// What a detector looks for.
struct DetectorOptions {
  /// (8–1000 px) Shortest marker, as a quarter of its perimeter. Smaller ones are mostly
  /// undecodable, and every step down finds more false quads and takes more time.
  double min_side_px = 12;
  /// Who finds them; every family must be known to it.
  DetectorEngine engine = kBestEngine;

  /// usage, naming the field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Has detectors do all of their work in the threads that call them, from now on and in the whole
/// process: OpenCV else spreads it over threads of its own, which have no real-time priority.
void detect_in_calling_threads();

/// A detector for all `families` (at least one, known to the engine; repeated ones count once).
/// Families and options are valid (checked).
[[nodiscard]] std::unique_ptr<MarkerDetector> make_detector(std::span<const Family> families,
                                                            const DetectorOptions& options = {});

}  // namespace waymark
