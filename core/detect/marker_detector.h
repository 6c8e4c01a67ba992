#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/range.h"
#include "core/capture/detection.h"
#include "core/capture/gray_image.h"
#include "core/marker/family.h"

namespace waymark {

/// Finds and decodes markers: the seam behind which OpenCV's or libapriltag's detector stands.
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

/// What a detector looks for.
struct DetectorOptions {
  /// (8–1000 px) Shortest marker, as a quarter of its perimeter. Smaller ones are mostly
  /// undecodable, and every step down finds more false quads and takes more time.
  double min_side_px = 12;

  /// usage, naming the field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Has detectors do all of their work in the threads that call them, from now on and in the whole
/// process: OpenCV else spreads it over threads of its own, which have no real-time priority.
void detect_in_calling_threads();

/// Which library finds and decodes.
enum class DetectorEngine {
  opencv,    ///< every family
  apriltag,  ///< libapriltag: the tag* families only
};

/// Whether the engine decodes the family.
[[nodiscard]] bool engine_knows(DetectorEngine engine, Family family);

/// The better engine for a family by measurement (bench_detect_engines): OpenCV, for every one.
/// On tag_table's 15 photos it finds all 41 markers and nothing else (libapriltag, given ArUco's
/// codes: 41 and false ids at full resolution); on office_wall's 39 photos 162 against 158, none
/// false, both 56 ids, in a third of the time. On rendered 36h11 with noise both find 98–100 % from
/// 24 px side up at tilts to 60°; at 18 px OpenCV finds 98 % upright and 71 % at 60° (libapriltag
/// 100 and 69 %), below that libapriltag finds more, for 10 to 30 times the time: an image of noise
/// takes it a second.
[[nodiscard]] DetectorEngine best_engine(Family family);

/// A detector for all `families` (at least one; repeated ones count once), each found by its best
/// engine. Families and options are valid (checked).
[[nodiscard]] std::unique_ptr<MarkerDetector> make_detector(std::span<const Family> families,
                                                            const DetectorOptions& options = {});

/// The same with one engine for all, which must know them (checked).
[[nodiscard]] std::unique_ptr<MarkerDetector> make_detector(DetectorEngine engine,
                                                            std::span<const Family> families,
                                                            const DetectorOptions& options = {});

}  // namespace waymark
