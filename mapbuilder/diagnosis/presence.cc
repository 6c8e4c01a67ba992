#include "mapbuilder/diagnosis/presence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/base/parallel.h"
#include "core/base/range.h"
#include "mapbuilder/diagnosis/clear_sight.h"

namespace waymark {
namespace {

/// Frame sets of one capture that found a marker, and that would have.
struct Looks {
  int found = 0;
  int empty = 0;
};

/// First and last stamp of some captures.
std::pair<Stamp, Stamp> span_of(const Observations& observations,
                                const std::vector<CaptureIndex>& captures) {
  std::pair<Stamp, Stamp> span{Stamp::max(), Stamp::min()};
  for (const ObservedFrameSet& set : observations.frame_sets) {
    if (std::find(captures.begin(), captures.end(), set.capture) == captures.end()) continue;
    span.first = std::min(span.first, set.stamp);
    span.second = std::max(span.second, set.stamp);
  }
  return span;
}

std::map<CaptureIndex, Looks> looks_at(const MapEvidence& evidence, MarkerIndex marker) {
  std::map<CaptureIndex, Looks> looks;
  const auto views = evidence.views_of(marker, 0);
  std::set<FrameSetIndex> found;
  double least_side_px = std::numeric_limits<double>::infinity();
  double reach_m = 0;  // farther rigs need not be asked
  const Eigen::Vector3d& x_in_world = evidence.place(marker)->world_from_marker.translation;
  const auto distance_m = [&](FrameSetIndex frame_set) {
    return (evidence.world_from_rig(frame_set)->translation - x_in_world).norm();
  };
  std::set<FrameSetIndex> nearly;
  for (const MarkerView& view : views) {
    // A wrong id that was read once elsewhere is no sighting; what the gate rejects close by is no
    // absence either.
    if (!view.accepted) {
      if (distance_px(view, *evidence.place(marker)) < side_px(view)) {
        nearly.insert(view.frame_set);
      }
      continue;
    }
    found.insert(view.frame_set);
    least_side_px = std::min(least_side_px, side_px(view));
    reach_m = std::max(reach_m, distance_m(view.frame_set));
  }
  for (const FrameSetIndex f : evidence.frame_sets()) {
    if (!evidence.world_from_rig(f)) continue;
    const ObservedFrameSet& set = evidence.observations().frame_sets[f];
    if (found.contains(f)) {
      ++looks[set.capture].found;
    } else if (!nearly.contains(f) && distance_m(f) <= reach_m &&
               has_clear_sight(evidence, f, *evidence.place(marker), least_side_px)) {
      ++looks[set.capture].empty;
    }
  }
  return looks;
}

std::optional<PartTimeMarker> part_time(const MapEvidence& evidence, MarkerIndex marker,
                                        const PresenceOptions& options) {
  constexpr double kMostFound = 0.9;  // nobody finds every marker every time
  PartTimeMarker result;
  result.marker = marker;
  double found = 0;
  double looked = 0;
  for (const auto& [capture, looks] : looks_at(evidence, marker)) {
    if (looks.found > 0) {
      result.seen_in.push_back(capture);
      found += looks.found;
      looked += looks.found + looks.empty;
    } else {
      result.empty_in.push_back(capture);
      result.empty_looks += looks.empty;
    }
  }
  if (result.seen_in.empty() || result.empty_in.empty()) return std::nullopt;
  const double missed = 1.0 - std::min(kMostFound, found / looked);
  if (std::pow(missed, result.empty_looks) > options.most_by_chance) return std::nullopt;
  const auto monotonic = [&](CaptureIndex capture) {
    return evidence.observations().captures[capture].monotonic;
  };
  // Stamps that count from the start of a computer say nothing across captures.
  if (std::any_of(result.seen_in.begin(), result.seen_in.end(), monotonic) ||
      std::any_of(result.empty_in.begin(), result.empty_in.end(), monotonic)) {
    return result;
  }
  const auto seen = span_of(evidence.observations(), result.seen_in);
  const auto empty = span_of(evidence.observations(), result.empty_in);
  if (empty.second < seen.first) result.appeared = true;
  if (seen.second < empty.first) result.appeared = false;
  return result;
}

}  // namespace

Status PresenceOptions::check() const {
  return RangeCheck().field("most_by_chance", most_by_chance, {1e-9, 0.01}).status();
}

std::vector<PartTimeMarker> find_part_time_markers(const MapEvidence& evidence,
                                                   const PresenceOptions& options) {
  std::vector<PartTimeMarker> found;
  if (evidence.observations().captures.size() < 2) return found;
  const std::vector<MarkerIndex>& markers = evidence.markers();
  std::vector<std::optional<PartTimeMarker>> each(markers.size());
  parallel_for(markers.size(), evidence.options().threads, [&](std::size_t i) {
    if (evidence.place(markers[i])) each[i] = part_time(evidence, markers[i], options);
  });
  for (auto& one : each) {
    if (one) found.push_back(*std::move(one));
  }
  return found;
}

}  // namespace waymark
