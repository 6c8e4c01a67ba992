#include "mapbuilder/diagnosis/clock_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/median.h"

namespace waymark {
namespace {

/// Fewer images of a camera tell no rhythm.
constexpr std::size_t kMinImages = 8;
/// A camera of which this share is in frame sets with others keeps their time.
constexpr double kKeepsTime = 0.9;
/// What departs from a constant or drifting offset by less than the tolerance, in this share of the
/// images, follows it: an image may be lost now and then.
constexpr double kFollows = 0.8;
/// Clocks that are set back in step now and then drift in stairs: a step of this share of the whole
/// drift is still part of it.
constexpr double kStairs = 0.15;

/// Stamps per camera, rising, and how many of them are in a frame set with another camera.
struct CameraStamps {
  std::vector<Stamp> stamps;
  std::size_t shared = 0;

  [[nodiscard]] double shared_share() const {
    return stamps.empty() ? 0.0 : static_cast<double>(shared) / static_cast<double>(stamps.size());
  }
};

std::vector<CameraStamps> stamps_of(std::span<const StampedImage> images, std::size_t cameras,
                                    Stamp tolerance) {
  std::vector<CameraStamps> all(cameras);
  for (const StampedImage& image : images) {
    all[static_cast<std::size_t>(image.camera)].stamps.push_back(image.stamp);
  }
  for (CameraStamps& one : all) std::sort(one.stamps.begin(), one.stamps.end());
  for (const FrameSet& set : group_into_frame_sets(images, tolerance)) {
    if (set.images.size() < 2) continue;
    for (const std::size_t i : set.images) ++all[static_cast<std::size_t>(images[i].camera)].shared;
  }
  return all;
}

/// Offset of a camera's stamps from a reference's as a line over time: at the first stamp (s), and
/// by how much it grows (s/s).
struct OffsetLine {
  double first_s = 0;
  double drift = 0;
};

/// Each stamp less the nearest of the reference, carried on from one to the next: between two
/// images an offset moves by less than half a period.
std::vector<double> offsets_from(const std::vector<Stamp>& reference,
                                 const std::vector<Stamp>& stamps, double period_s) {
  std::vector<double> offsets;
  for (const Stamp stamp : stamps) {
    const auto after = std::lower_bound(reference.begin(), reference.end(), stamp);
    double offset = std::numeric_limits<double>::infinity();
    if (after != reference.end()) offset = in_s(stamp - *after);
    if (after != reference.begin() && in_s(stamp - *std::prev(after)) < std::abs(offset)) {
      offset = in_s(stamp - *std::prev(after));
    }
    if (!offsets.empty()) offset += period_s * std::round((offsets.back() - offset) / period_s);
    offsets.push_back(offset);
  }
  return offsets;
}

double period_of(const std::vector<Stamp>& stamps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    steps.push_back(in_s(stamps[i] - stamps[i - 1]));
  }
  return upper_median(steps);
}

/// How fast the offsets grow (s/s): the median over pairs at least a third of the series apart
/// (Theil and Sen's), of at most 200 stamps.
std::optional<double> drift_of(const std::vector<Stamp>& stamps,
                               const std::vector<double>& offsets) {
  constexpr std::size_t kMost = 200;
  const std::size_t every = 1 + stamps.size() / (kMost + 1);
  const std::size_t third = stamps.size() / 3;
  std::vector<double> slopes;
  for (std::size_t i = 0; i < stamps.size(); i += every) {
    for (std::size_t j = i + third; j < stamps.size(); j += every) {
      const double step = in_s(stamps[j] - stamps[i]);
      if (step > 0) slopes.push_back((offsets[j] - offsets[i]) / step);
    }
  }
  if (slopes.empty()) return std::nullopt;
  return upper_median(slopes);
}

/// The line that the offsets follow; nullopt: none.
std::optional<OffsetLine> line_of(const std::vector<Stamp>& stamps,
                                  const std::vector<double>& offsets, double tolerance_s) {
  const auto drift = drift_of(stamps, offsets);
  if (!drift) return std::nullopt;
  OffsetLine line{0, *drift};
  std::vector<double> firsts;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    firsts.push_back(offsets[i] - line.drift * in_s(stamps[i] - stamps.front()));
  }
  line.first_s = upper_median(firsts);
  const double grown_s = std::abs(line.drift) * in_s(stamps.back() - stamps.front());
  const double near_s = std::max(tolerance_s, kStairs * grown_s);
  const auto follow = std::count_if(firsts.begin(), firsts.end(), [&](double first) {
    return std::abs(first - line.first_s) <= near_s;
  });
  if (static_cast<double>(follow) < kFollows * static_cast<double>(firsts.size())) {
    return std::nullopt;
  }
  return line;
}

std::string duration_text(double duration_s) {
  constexpr double kYear_s = 365.25 * 86400;
  if (duration_s >= kYear_s) return fmt::format("{:.1f} years", duration_s / kYear_s);
  if (duration_s >= 86400) return fmt::format("{:.1f} days", duration_s / 86400);
  if (duration_s >= 3600) return fmt::format("{:.1f} hours", duration_s / 3600);
  if (duration_s >= 1) return fmt::format("{:.1f} s", duration_s);
  return fmt::format("{:.1f} ms", 1e3 * duration_s);
}

Finding clock_finding(const std::string& camera, std::string text, Figure figure) {
  Finding finding;
  finding.severity = Severity::warning;
  finding.cause = Cause::clock;
  finding.subject = camera;
  finding.text = std::move(text);
  finding.remedy = "Stamp all cameras by one clock, and record again.";
  finding.cameras = {camera};
  finding.figures = {std::move(figure)};
  return finding;
}

/// What is the matter with a camera that is not in the others' frame sets.
std::optional<Finding> judge(const CameraStamps& camera, const std::string& name,
                             const CameraStamps& reference, const std::string& reference_name,
                             Stamp tolerance) {
  const Stamp gap = std::max(camera.stamps.front() - reference.stamps.back(),
                             reference.stamps.front() - camera.stamps.back());
  const Stamp span = std::max(camera.stamps.back() - camera.stamps.front(),
                              reference.stamps.back() - reference.stamps.front());
  if (gap > span) {
    const double apart_s = std::abs(in_s(camera.stamps.front() - reference.stamps.front()));
    return clock_finding(
        name,
        fmt::format("no frame set holds it: its stamps lie {} {} those of {}, by another clock.",
                    duration_text(apart_s),
                    camera.stamps.front() < reference.stamps.front() ? "before" : "after",
                    reference_name),
        {"apart", apart_s, "s", {}});
  }
  const double tolerance_s = in_s(tolerance);
  const double period_s = period_of(reference.stamps);
  if (!(period_s > 0)) return std::nullopt;
  const auto offsets = offsets_from(reference.stamps, camera.stamps, period_s);
  const auto line = line_of(camera.stamps, offsets, tolerance_s);
  if (!line) return std::nullopt;
  const double grown_s = line->drift * in_s(camera.stamps.back() - camera.stamps.front());
  if (std::abs(grown_s) > tolerance_s) {
    std::size_t apart = 0;
    while (apart + 1 < offsets.size() && std::abs(offsets[apart]) <= tolerance_s) ++apart;
    return clock_finding(
        name,
        fmt::format("its clock drifts by {:.1f} ms a minute against {}: frame sets fall apart from "
                    "{} on.",
                    60e3 * line->drift, reference_name, camera.stamps[apart].count()),
        {"drift", 60e3 * line->drift, "ms/min", {}});
  }
  if (std::abs(line->first_s) <= tolerance_s) return std::nullopt;
  return clock_finding(
      name,
      fmt::format("no frame set holds it: its stamps are {} {} those of {}, and the tolerance is "
                  "{:.1f} ms.",
                  duration_text(std::abs(line->first_s)), line->first_s > 0 ? "ahead of" : "behind",
                  reference_name, 1e3 * tolerance_s),
      {"apart", 1e3 * line->first_s, "ms", {}});
}

}  // namespace

std::vector<Finding> clock_findings(std::span<const StampedImage> images,
                                    const std::vector<std::string>& cameras, Stamp tolerance) {
  std::vector<Finding> findings;
  const auto all = stamps_of(images, cameras.size(), tolerance);
  // Whom most images agree with tells the time; of two that agree with nobody, the first.
  const auto reference =
      static_cast<std::size_t>(std::max_element(all.begin(), all.end(),
                                                [](const CameraStamps& a, const CameraStamps& b) {
                                                  return a.shared < b.shared;
                                                }) -
                               all.begin());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool tells =
        all[k].stamps.size() >= kMinImages && all[reference].stamps.size() >= kMinImages;
    if (k == reference || !tells || all[k].shared_share() >= kKeepsTime) continue;
    auto finding = judge(all[k], cameras[k], all[reference], cameras[reference], tolerance);
    if (finding) findings.push_back(*std::move(finding));
  }
  return findings;
}

std::vector<Finding> clock_findings(const std::vector<DetectedCapture>& captures) {
  std::vector<Finding> findings;
  for (const DetectedCapture& capture : captures) {
    std::vector<StampedImage> images;
    for (const ImageDetections& image : capture.images) {
      images.push_back({image.camera, image.stamp});
    }
    std::vector<std::string> cameras;
    for (const RigCamera& camera : capture.rig.cameras) cameras.push_back(camera.name);
    for (Finding& finding : clock_findings(images, cameras, capture.sync_tolerance)) {
      findings.push_back(std::move(finding));
    }
  }
  return findings;
}

}  // namespace waymark
