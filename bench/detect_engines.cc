// All detectors by turns on the same images, in one thread: processor time per image, what each
// finds of all that any finds, by size and by tilt, and false markers.
// Usage: bench_detect_engines [--absent FAMILY] [--only DETECTOR] [--list] CAPTURE...
// With --absent the captures' images are searched for a family that they do not show: whatever is
// found is false. A find counts when its corners can be refined and its cells read with them, as
// ImageDetector has it; "rough" are all.

#include <fmt/core.h>

#include <Eigen/SVD>
#include <algorithm>
#include <ctime>
#include <map>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "bench/detector_referees.h"
#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "core/detect/cell_reader.h"
#include "core/detect/code_table.h"
#include "core/detect/corner_refiner.h"
#include "core/detect/negative_image.h"
#include "core/marker/marker_bits.h"
#include "core/marker/marker_outline.h"

namespace {

using namespace waymark;  // NOLINT(google-build-using-namespace): a program of one file

double thread_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double tilt_deg(const ImageCorners& c) {
  Eigen::Matrix2d sides;
  sides << 0.5 * (c[1] - c[0] + c[2] - c[3]), 0.5 * (c[3] - c[0] + c[2] - c[1]);
  const Eigen::Vector2d lengths = Eigen::JacobiSVD<Eigen::Matrix2d>(sides).singularValues();
  return std::acos(std::min(1.0, lengths[1] / lengths[0])) * 57.29578;
}

/// A bin of a table, by its lower end.
struct Bins {
  const char* name;
  std::vector<double> begins;
  [[nodiscard]] std::size_t of(double value) const {
    std::size_t bin = 0;
    while (bin + 1 < begins.size() && value >= begins[bin + 1]) ++bin;
    return bin;
  }
};
const Bins kSides{"side px", {0, 14, 20, 25, 35, 50, 80, 110}};
const Bins kTilts{"tilt deg", {0, 30, 45, 60, 70, 75, 80}};

/// A marker in one image and which detectors (bits) found it.
struct Shown {
  Detection detection;
  unsigned found_by = 0;
};

struct Tally {
  std::vector<double> ms;
  int rough = 0;
  int kept = 0;
  std::map<std::size_t, int> by_side;
  std::map<std::size_t, int> by_tilt;
};

class Comparison {
 public:
  Comparison(Family family, const std::string& only, bool list) : list_(list) {
    detectors_ = bench::all_detectors(family);
    if (!only.empty()) {
      std::erase_if(detectors_, [&](const auto& one) { return one.name != only; });
    }
    tallies_.resize(detectors_.size());
  }

  void add(const GrayView& image, const CameraModel& camera, const std::string& name) {
    std::vector<Shown> shown;
    for (std::size_t k = 0; k < detectors_.size(); ++k) {
      const double begin = thread_seconds();
      const std::vector<Detection>& found = detectors_[k].detector->detect(image);
      tallies_[k].ms.push_back(1e3 * (thread_seconds() - begin));
      tallies_[k].rough += static_cast<int>(found.size());
      for (const Detection& rough : found) {
        if (const auto kept = confirmed(image, camera, rough)) note(*kept, 1U << k, shown);
      }
    }
    for (const Shown& one : shown) count(one, name);
  }

  void print(const std::string& title) const {
    fmt::print("{}: {} images, {} markers\n", title, tallies_[0].ms.size(), union_.kept);
    for (std::size_t k = 0; k < detectors_.size(); ++k) {
      const Tally& tally = tallies_[k];
      fmt::print("| {:<14} | ms: {:7.2f} median, {:7.2f} max | {:5} rough | {:4} of {} |",
                 detectors_[k].name, median(tally.ms),
                 *std::max_element(tally.ms.begin(), tally.ms.end()), tally.rough, tally.kept,
                 union_.kept);
      print_bins(kSides, tally.by_side, union_.by_side);
      print_bins(kTilts, tally.by_tilt, union_.by_tilt);
      fmt::print("\n");
    }
    std::fflush(stdout);
  }

 private:
  static double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
  }

  static void print_bins(const Bins& bins, const std::map<std::size_t, int>& found,
                         const std::map<std::size_t, int>& all) {
    fmt::print(" {}:", bins.name);
    for (const auto& [bin, count] : all) {
      fmt::print(" ≥{:.0f} {}/{}", bins.begins[bin], found.contains(bin) ? found.at(bin) : 0,
                 count);
    }
    fmt::print(" |");
  }

  std::optional<Detection> confirmed(const GrayView& image, const CameraModel& camera,
                                     const Detection& rough) const {
    MarkerBits bits = marker_bits(rough.marker);
    NegativeImage negative;
    GrayView shown = image;
    if (bits.is_light()) {
      shown = negative.of(image);
      bits = negative_of(bits);
    }
    const auto refined = refine_corners(shown, camera, rough.corners, bits);
    if (!refined) return std::nullopt;
    const auto cells = read_cells(shown, refined->corners, bits);
    if (!cells || cells->wrong_code_cells > correctable_bits(rough.marker.family) ||
        cells->wrong_other_cells > cells->other_cells / 8) {
      return std::nullopt;
    }
    return Detection{rough.marker, refined->corners, refined->covariances, cells->wrong_code_cells};
  }

  static void note(const Detection& found, unsigned by, std::vector<Shown>& shown) {
    for (Shown& known : shown) {
      if (known.detection.marker != found.marker) continue;
      const Eigen::Vector2d off = centre_of(known.detection.corners) - centre_of(found.corners);
      if (off.norm() > 0.2 * mean_side_px(found.corners)) continue;
      known.found_by |= by;
      return;
    }
    shown.push_back({found, by});
  }

  static void count(const Detection& detection, Tally& tally) {
    ++tally.kept;
    ++tally.by_side[kSides.of(mean_side_px(detection.corners))];
    ++tally.by_tilt[kTilts.of(tilt_deg(detection.corners))];
  }

  void count(const Shown& one, const std::string& image) {
    count(one.detection, union_);
    for (std::size_t k = 0; k < tallies_.size(); ++k) {
      if ((one.found_by >> k & 1U) != 0) count(one.detection, tallies_[k]);
    }
    const bool all = one.found_by + 1 == 1U << tallies_.size();
    if (!list_ || all) return;
    const Eigen::Vector2d at = centre_of(one.detection.corners);
    fmt::print("{} id {} at {:.0f} {:.0f} side {:.0f} tilt {:.0f} hamming {}: by", image,
               one.detection.marker.number, at.x(), at.y(), mean_side_px(one.detection.corners),
               tilt_deg(one.detection.corners), one.detection.hamming);
    for (std::size_t k = 0; k < tallies_.size(); ++k) {
      if ((one.found_by >> k & 1U) != 0) fmt::print(" [{}]", detectors_[k].name);
    }
    fmt::print("\n");
  }

  bool list_;
  std::vector<bench::NamedDetector> detectors_;
  std::vector<Tally> tallies_;
  Tally union_;
};

void compare(const std::string& path, std::optional<Family> absent, const std::string& only,
             bool list) {
  const auto capture = open_capture_folder(path);
  if (!capture) {
    fmt::print(stderr, "{}\n", capture.error().message);
    return;
  }
  Comparison comparison(absent.value_or(capture->catalog.entries().front().family), only, list);
  for (const ImageFile& file : capture->images) {
    const auto loaded = read_gray_image(file.path);
    if (!loaded) continue;
    const CameraModel& camera = capture->rig.cameras[static_cast<std::size_t>(file.camera)].model;
    comparison.add(loaded->image.view(), camera, file.path.string());
  }
  comparison.print(path);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  std::optional<Family> absent;
  bool list = false;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--list") {
      list = true;
    } else if (argument == "--only" && i + 1 < argc) {
      only = argv[++i];
    } else if (argument == "--absent" && i + 1 < argc) {
      absent = family_from_name(argv[++i]);
      if (!absent) return 64;
    } else {
      compare(argument, absent, only, list);
    }
  }
}
