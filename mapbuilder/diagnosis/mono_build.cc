#include "mapbuilder/diagnosis/mono_build.h"

#include <algorithm>
#include <map>
#include <set>

#include "mapbuilder/growth/relocalization.h"

namespace waymark {
namespace {

constexpr std::size_t kImages = 60;
constexpr int kTogether = 3;

/// Counts in how many images two markers were seen together.
class Pairs {
 public:
  /// Whether an image shows two that have hardly been seen together.
  [[nodiscard]] bool are_told_by(const ImageDetections& image) const {
    const std::vector<MarkerId> ids = ids_of(image);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      for (std::size_t j = i + 1; j < ids.size(); ++j) {
        const auto known = count_.find({ids[i], ids[j]});
        if (known == count_.end() || known->second < kTogether) return true;
      }
    }
    return false;
  }

  void add(const ImageDetections& image) {
    const std::vector<MarkerId> ids = ids_of(image);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      for (std::size_t j = i + 1; j < ids.size(); ++j) ++count_[{ids[i], ids[j]}];
    }
  }

 private:
  static std::vector<MarkerId> ids_of(const ImageDetections& image) {
    std::set<MarkerId> ids;
    for (const Detection& detection : image.detections) ids.insert(detection.marker);
    return {ids.begin(), ids.end()};
  }

  std::map<std::pair<MarkerId, MarkerId>, int> count_;
};

/// Of every image, whether it is one of its camera's, evenly spread.
std::vector<char> evenly_spread(const std::vector<ImageDetections>& images) {
  std::map<int, std::size_t> count;
  for (const ImageDetections& image : images) {
    if (!image.detections.empty()) ++count[image.camera];
  }
  std::map<int, std::size_t> seen;
  std::vector<char> chosen;
  for (const ImageDetections& image : images) {
    const std::size_t every = 1 + count[image.camera] / (kImages + 1);
    chosen.push_back(!image.detections.empty() && seen[image.camera]++ % every == 0 ? 1 : 0);
  }
  return chosen;
}

/// The largest sub-map by what explains the images best.
SubMap best_map(const MonoBuild& mono) {
  SubMap map = mono.result.submaps.front().map;
  std::map<MarkerId, Rigid3> places;
  const Estimate& estimate = mono.result.evidence();
  for (const MarkerIndex m : mono.observations.markers.indices()) {
    const auto& place = estimate.world_from_marker[m];
    if (place) places.emplace(mono.observations.markers[m], *place);
  }
  std::erase_if(map.markers, [&](const MapMarker& marker) { return !places.contains(marker.id); });
  for (MapMarker& marker : map.markers) marker.world_from_marker = places.at(marker.id);
  return map;
}

}  // namespace

std::optional<RigIndex> MonoBuild::rig_of(std::size_t capture, std::size_t camera) const {
  for (const ObservedFrameSet& set : observations.frame_sets) {
    if (observations.captures[set.capture].place == capture &&
        set.mono_camera.value_or(0) == static_cast<int>(camera)) {
      return set.rig;
    }
  }
  return std::nullopt;
}

std::optional<MonoBuild> build_mono(const std::vector<DetectedCapture>& captures,
                                    const BuildOptions& options, MonoLenses lenses) {
  auto observations = make_observations(captures, {true, options.threads});
  if (!observations) return std::nullopt;
  BuildOptions mono = options;
  mono.refine = {};
  mono.survey = {};
  if (lenses != MonoLenses::kept) {
    // What is looked for is which numbers are wrong, not a calibration to drive by.
    mono.refine.intrinsics = true;
    mono.refine.straight_lenses_bend = lenses == MonoLenses::refined;
    mono.refinement_limits.focal = 0.01;
    mono.refinement_limits.rotation_rad = 0.0087;  // 0.5°
  }
  Progress silent(false);
  MonoBuild build{*std::move(observations), {}};
  build.result = build_map(Selection(build.observations), mono, silent);
  if (build.result.submaps.empty()) return std::nullopt;
  return build;
}

std::vector<DetectedCapture> telling_images(std::vector<DetectedCapture> captures) {
  for (DetectedCapture& capture : captures) {
    std::vector<char> chosen = evenly_spread(capture.images);
    Pairs pairs;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i] != 0) pairs.add(capture.images[i]);
    }
    std::vector<ImageDetections> telling;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i] == 0) {
        if (!pairs.are_told_by(capture.images[i])) continue;
        pairs.add(capture.images[i]);
      }
      telling.push_back(std::move(capture.images[i]));
    }
    capture.images = std::move(telling);
  }
  return captures;
}

std::optional<LocalizedImages> localize_images(const DetectedCapture& capture,
                                               const MonoBuild& mono, const BuildOptions& options) {
  auto observations = make_observations({capture}, {true, options.threads});
  if (!observations) return std::nullopt;
  LocalizedImages localized{*std::move(observations), best_map(mono), {}, 0};
  MarkerMap map;
  map.submaps = {localized.map};
  Progress silent(false);
  auto relocalized = relocalize(localized.observations, map, options, silent);
  localized.trajectory = std::move(relocalized.front().trajectory);
  localized.model_sigma_px = relocalized.front().model_sigma_px;
  return localized;
}

}  // namespace waymark
