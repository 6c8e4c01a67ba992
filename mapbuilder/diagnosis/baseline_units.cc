#include "mapbuilder/diagnosis/baseline_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/estimate/ippe.h"

namespace waymark {
namespace {

/// A unit that may have been written for metres.
struct Unit {
  const char* name;
  double metres;
  double near;  ///< share of it that a scale may be off: little where a mere fault comes close
};
constexpr std::array<Unit, 3> kUnits{
    {{"millimetres", 0.001, 0.25}, {"centimetres", 0.01, 0.25}, {"inches", 0.0254, 0.25}}};

/// Longer baselines than hardly a rig has.
constexpr double kLongBaseline_m = 3.0;

/// One sight of a marker by itself.
struct View {
  ImageCorners corners_px;
  Rigid3 cam_from_marker;
};

/// The views of markers that a camera has in a frame set.
using Views = std::map<MarkerIndex, View>;

Views views_of(const Observations& observations, const ObservedFrameSet& set, std::size_t camera) {
  Views views;
  for (const ObservationIndex index : set.observations) {
    const Observation& o = observations[index];
    if (observations.camera_in_rig(o) != camera) continue;
    const RigCamera& seen_by = observations.rigs[set.rig].cameras[camera];
    const auto solutions =
        solve_ippe(seen_by.model, o.corners_px, observations.stated_sizes_m[o.marker]);
    if (solutions) views[o.marker] = {o.corners_px, solutions->cam_from_marker[0]};
  }
  return views;
}

/// How the camera moved between two frame sets, by the marker that both see largest.
std::optional<Rigid3> motion_of(const Views& now, const Views& then) {
  double largest_px2 = 0;
  std::optional<Rigid3> motion;
  for (const auto& [marker, view] : now) {
    const auto earlier = then.find(marker);
    if (earlier == then.end()) continue;
    const double size_px2 =
        std::min(area_px2(view.corners_px), area_px2(earlier->second.corners_px));
    if (size_px2 <= largest_px2) continue;
    largest_px2 = size_px2;
    motion = view.cam_from_marker * earlier->second.cam_from_marker.inverse();
  }
  return motion;
}

/// `lever` × the baselines' true scale = `seen` (m), along the lever.
struct Sample {
  double lever_m;
  double scale;
};

/// Two cameras' motions between the same two frame sets, on a rig that turned.
std::optional<Sample> sample_of(const RigCamera& a, const RigCamera& b, const Rigid3& motion_a,
                                const Rigid3& motion_b) {
  constexpr double kSameTurn_rad = 0.1;
  // What a marker's pose is off by makes levers longer and the scale smaller: not by a tenth.
  constexpr double kLeastTurn_rad = 0.3;
  constexpr double kLeastLever_m = 0.02;
  const auto turn = [](const RigCamera& camera, const Rigid3& motion) {
    const Eigen::Quaterniond& q = camera.rig_from_cam.rotation;
    return Eigen::Quaterniond(q * motion.rotation * q.conjugate());
  };
  const Eigen::Quaterniond turn_a = turn(a, motion_a);
  const Eigen::Quaterniond turn_b = turn(b, motion_b);
  if (angle_between_rad(turn_a, Eigen::Quaterniond::Identity()) < kLeastTurn_rad) {
    return std::nullopt;
  }
  // A flipped pose, or a rig whose rotations are wrong: that says nothing of lengths.
  if (angle_between_rad(turn_a, turn_b) > kSameTurn_rad) return std::nullopt;
  const Eigen::Vector3d baseline = a.rig_from_cam.translation - b.rig_from_cam.translation;
  const Eigen::Vector3d lever = baseline - turn_a * baseline;
  if (lever.norm() < kLeastLever_m) return std::nullopt;
  const Eigen::Vector3d seen = b.rig_from_cam.rotation * motion_b.translation -
                               a.rig_from_cam.rotation * motion_a.translation;
  return Sample{lever.norm(), seen.dot(lever) / lever.squaredNorm()};
}

/// All samples of a pair of cameras.
std::vector<Sample> samples_of(const Observations& observations, RigIndex rig, std::size_t a,
                               std::size_t b) {
  constexpr std::size_t kMost = 4000;
  std::vector<std::pair<Views, Views>> sets;
  for (const ObservedFrameSet& set : observations.frame_sets) {
    if (set.rig != rig || set.mono_camera) continue;
    sets.emplace_back(views_of(observations, set, a), views_of(observations, set, b));
    if (sets.back().first.empty() || sets.back().second.empty()) sets.pop_back();
  }
  const auto& cameras = observations.rigs[rig].cameras;
  const RigCamera& first = cameras[a];
  const RigCamera& second = cameras[b];
  std::vector<Sample> samples;
  for (std::size_t lag = 1; lag < sets.size() && samples.size() < kMost; lag *= 2) {
    for (std::size_t i = lag; i < sets.size() && samples.size() < kMost; ++i) {
      const auto motion_a = motion_of(sets[i].first, sets[i - lag].first);
      const auto motion_b = motion_of(sets[i].second, sets[i - lag].second);
      if (!motion_a || !motion_b) continue;
      if (const auto sample = sample_of(first, second, *motion_a, *motion_b)) {
        samples.push_back(*sample);
      }
    }
  }
  return samples;
}

/// True baselines by stated ones.
struct Scale {
  double value = 1;
  double sigma = 0;
};

/// The weighted median, by the levers' squares: what a flipped pose says is outvoted.
std::optional<Scale> scale_of(std::vector<Sample> samples) {
  constexpr std::size_t kFewest = 12;
  if (samples.size() < kFewest) return std::nullopt;
  const auto weighted_median = [&samples] {
    std::sort(samples.begin(), samples.end(),
              [](const Sample& x, const Sample& y) { return x.scale < y.scale; });
    double all = 0;
    for (const Sample& sample : samples) all += sample.lever_m * sample.lever_m;
    double sum = 0;
    for (const Sample& sample : samples) {
      sum += sample.lever_m * sample.lever_m;
      if (2 * sum >= all) return sample.scale;
    }
    return samples.back().scale;
  };
  Scale scale;
  scale.value = weighted_median();
  for (Sample& sample : samples) sample.scale = std::abs(sample.scale - scale.value);
  // Neighbouring samples share their frame sets: a sigma as of a quarter of them.
  scale.sigma = 1.4826 * weighted_median() * 2 / std::sqrt(static_cast<double>(samples.size()));
  return scale;
}

/// The unit that a scale is, if it clearly is one.
const Unit* unit_of(const Scale& scale) {
  constexpr double kSigmas = 5;
  for (const Unit& unit : kUnits) {
    const double off = std::abs(scale.value - unit.metres);
    if (off < unit.near * unit.metres && kSigmas * scale.sigma < std::abs(1 - scale.value) &&
        scale.sigma < unit.near * unit.metres) {
      return &unit;
    }
  }
  return nullptr;
}

Finding about_pair(const RigCamera& a, const RigCamera& b) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::rig_unit;
  finding.subject = fmt::format("{}, {}", a.name, b.name);
  finding.cameras = {a.name, b.name};
  return finding;
}

std::optional<Finding> finding_of(const Observations& observations, RigIndex rig, std::size_t a,
                                  std::size_t b) {
  const auto& cameras = observations.rigs[rig].cameras;
  const RigCamera& first = cameras[a];
  const RigCamera& second = cameras[b];
  const double baseline_m =
      (first.rig_from_cam.translation - second.rig_from_cam.translation).norm();
  const auto scale = scale_of(samples_of(observations, rig, a, b));
  Finding finding = about_pair(first, second);
  if (scale) {
    finding.figures = {{"true baseline by stated", scale->value, "", scale->sigma}};
    if (const Unit* unit = unit_of(*scale)) {
      finding.text =
          fmt::format("{:.3g} m between them in rig.yaml: in {}? Their own motions show {:.3g} m.",
                      baseline_m, unit->name, scale->value * baseline_m);
      finding.remedy = "Write translations in metres.";
      return finding;
    }
    if (const Unit* unit =
            unit_of({1 / scale->value, scale->sigma / (scale->value * scale->value)})) {
      finding.cause = Cause::size_scale;
      finding.text = fmt::format(
          "their own motions show {:.3g} m between them, rig.yaml states {:.3g} m: are the sizes "
          "in "
          "markers.toml in {}?",
          scale->value * baseline_m, baseline_m, unit->name);
      finding.remedy = "Write size_m in metres.";
      return finding;
    }
    return std::nullopt;
  }
  if (baseline_m <= kLongBaseline_m) return std::nullopt;
  finding.severity = Severity::warning;
  finding.text = fmt::format(
      "{:.3g} m between them in rig.yaml: in another unit than metres? The images do not tell.",
      baseline_m);
  finding.remedy = "Compare with a ruler.";
  return finding;
}

}  // namespace

std::vector<Finding> baseline_findings(const Observations& observations) {
  std::vector<Finding> findings;
  for (const RigIndex rig : observations.rigs.indices()) {
    const std::size_t cameras = observations.rigs[rig].cameras.size();
    for (std::size_t a = 0; a + 1 < cameras; ++a) {
      // One file, one unit: neighbours tell enough.
      if (auto finding = finding_of(observations, rig, a, a + 1)) {
        findings.push_back(*std::move(finding));
      }
    }
  }
  return findings;
}

}  // namespace waymark
