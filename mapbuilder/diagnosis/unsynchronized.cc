#include "mapbuilder/diagnosis/unsynchronized.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/median.h"
#include "core/geometry/degrees.h"
#include "mapbuilder/diagnosis/rig_path.h"

namespace waymark {
namespace {

/// Fewer instants tell no scatter.
constexpr std::size_t kLeastInstants = 12;
/// By which the misfit's median must fall for moments of their own.
constexpr double kMustFall = 5.0;
/// What is left may be so many sigmas.
constexpr double kMostNoise = 3.0;
/// Below, shutters are together (s).
constexpr double kTogether_s = 0.0005;
/// As sure as a place is to begin with.
constexpr double kNoiseScale = 4.0;

/// The moment, within a period either way, at which the others' path has the camera nearest.
struct Moment {
  double offset_s = 0;
  double misfit = 0;  ///< sigmas²
};

class OneCamera {
 public:
  OneCamera(const CameraTracks& tracks, const Extrinsics& stated, std::size_t camera)
      : tracks_(tracks),
        stated_(stated),
        camera_(camera),
        path_(tracks, stated, kNoiseScale, static_cast<int>(camera)) {}

  std::optional<UnsynchronizedCamera> judge() const {
    if (!path_.moves()) return std::nullopt;
    std::vector<double> offsets;
    std::vector<double> before;
    std::vector<double> after;
    std::vector<double> speeds;
    std::vector<double> turns;
    for (std::size_t i = 0; i < tracks_.instants.size(); ++i) {
      const auto as_stamped = misfit(i, 0);
      const auto motion = path_.motion(i, kStep_s);
      if (!as_stamped || !motion) continue;
      const Moment moment = best_moment(i, *as_stamped);
      offsets.push_back(moment.offset_s);
      before.push_back(*as_stamped);
      after.push_back(moment.misfit);
      const Rigid3 moved = *motion * *path_.at(i);
      speeds.push_back((moved.translation - path_.at(i)->translation).norm() / kStep_s);
      turns.push_back(angle_between_rad(moved.rotation, path_.at(i)->rotation) / kStep_s);
    }
    if (offsets.size() < kLeastInstants) return std::nullopt;
    UnsynchronizedCamera found{camera_,
                               scatter_of(offsets),
                               upper_median(speeds),
                               upper_median(turns),
                               upper_median(before),
                               upper_median(after),
                               offsets.size()};
    const bool pays = found.misfit_before > kMustFall * found.misfit_after &&
                      found.misfit_after < kMostNoise * kMostNoise * kMedianOfChi2_5;
    if (!pays || found.scatter_s < kTogether_s) return std::nullopt;
    return found;
  }

 private:
  static constexpr double kStep_s = 0.01;

  static double scatter_of(std::vector<double> offsets) {
    const double middle = upper_median(offsets);
    std::vector<double> off;
    for (const double offset : offsets) off.push_back(std::abs(offset - middle));
    return upper_median(off) / kMedianOfNormal;
  }

  /// nullopt where camera or path tell nothing.
  std::optional<double> misfit(std::size_t instant, double offset_s) const {
    const auto& place = tracks_.instants[instant].places[camera_];
    if (!place || !path_.at(instant)) return std::nullopt;
    Rigid3 world_from_rig = *path_.at(instant);
    if (offset_s != 0) {
      const auto motion = path_.motion(instant, offset_s);
      if (!motion) return std::nullopt;
      world_from_rig = *motion * world_from_rig;
    }
    return squared_misfit(*place, world_from_rig * stated_[camera_], 1.0);
  }

  Moment best_moment(std::size_t instant, double as_stamped) const {
    constexpr int kSteps = 40;
    Moment best{0, as_stamped};
    const double reach = path_.period_s();
    double width = reach / kSteps;
    for (int s = -kSteps; s <= kSteps; ++s) try_moment(instant, s * width, best);
    for (int round = 0; round < 12; ++round) {
      const double middle = best.offset_s;
      try_moment(instant, middle - 0.5 * width, best);
      try_moment(instant, middle + 0.5 * width, best);
      width *= 0.6;
    }
    return best;
  }

  void try_moment(std::size_t instant, double offset_s, Moment& best) const {
    const auto there = misfit(instant, offset_s);
    if (there && *there < best.misfit) best = {offset_s, *there};
  }

  const CameraTracks& tracks_;
  const Extrinsics& stated_;
  std::size_t camera_;
  RigPath path_;
};

}  // namespace

std::vector<UnsynchronizedCamera> unsynchronized_cameras(const CameraTracks& tracks,
                                                         const Extrinsics& stated) {
  std::vector<UnsynchronizedCamera> found;
  CameraTracks rest = tracks;
  // One at a time, the surest first: it makes the others' path look as if these ran free.
  for (std::size_t round = 0; round + 1 < stated.size(); ++round) {
    std::optional<UnsynchronizedCamera> surest;
    for (std::size_t k = 0; k < stated.size(); ++k) {
      // Of two, the first is what the other is held against.
      if (stated.size() == 2 && k == 0) continue;
      const auto one = OneCamera(rest, stated, k).judge();
      if (one && (!surest || one->fall() > surest->fall())) surest = one;
    }
    if (!surest) break;
    found.push_back(*surest);
    for (CameraTracks::Instant& instant : rest.instants) instant.places[surest->camera].reset();
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.camera < b.camera; });
  return found;
}

std::optional<Finding> leave_out_unsynchronized(const CameraTracks& tracks,
                                                DetectedCapture& capture) {
  Extrinsics stated;
  for (const RigCamera& camera : capture.rig.cameras) stated.push_back(camera.rig_from_cam);
  const auto found = unsynchronized_cameras(tracks, stated);
  if (found.empty()) return std::nullopt;
  const auto worst = std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return a.scatter_s < b.scatter_s;
  });
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::clock;
  for (const UnsynchronizedCamera& one : found) {
    finding.cameras.push_back(capture.rig.cameras[one.camera].name);
  }
  finding.subject = fmt::format("{}", fmt::join(finding.cameras, ", "));
  finding.captures = {capture.name};
  finding.text = fmt::format(
      "images are not taken together with the others': their moments scatter by ± {:.1f} ms from "
      "frame set to frame set, which is ± {:.0f} mm and ± {:.2f}° at the rig's speed of {:.2f} m/s "
      "and {:.0f}°/s; each image alone fits. Left out.",
      1e3 * worst->scatter_s, 1e3 * worst->scatter_s * worst->speed_mps,
      kDegreesPerRadian * worst->scatter_s * worst->turn_rad_per_s, worst->speed_mps,
      kDegreesPerRadian * worst->turn_rad_per_s);
  finding.remedy = "Trigger the cameras together; or build with --mono.";
  finding.explains = fmt::format("{} frame sets", worst->instants);
  finding.figures = {{"scatter", 1e3 * worst->scatter_s, "ms", {}},
                     {"speed", worst->speed_mps, "m/s", {}},
                     {"turning", kDegreesPerRadian * worst->turn_rad_per_s, "°/s", {}}};
  std::erase_if(capture.images, [&](const ImageDetections& image) {
    return std::any_of(found.begin(), found.end(), [&](const UnsynchronizedCamera& one) {
      return one.camera == static_cast<std::size_t>(image.camera);
    });
  });
  return finding;
}

}  // namespace waymark
