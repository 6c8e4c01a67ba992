#include "mapbuilder/diagnosis/place_history.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/base/range.h"
#include "mapbuilder/diagnosis/clear_sight.h"

namespace waymark {
namespace {

/// Stamps of one capture at which a place was seen.
struct Period {
  Stamp first = Stamp::max();
  Stamp last = Stamp::min();
  void add(Stamp stamp) {
    first = std::min(first, stamp);
    last = std::max(last, stamp);
  }
  [[nodiscard]] bool holds(Stamp stamp) const { return first <= stamp && stamp <= last; }
};

const ObservedFrameSet& frame_set_of(const MapEvidence& evidence, FrameSetIndex index) {
  return evidence.observations().frame_sets[index];
}

double smallest_side_px(const PlaceCluster& cluster) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const MarkerView& view : cluster.views) smallest = std::min(smallest, side_px(view));
  return smallest;
}

/// When a place was seen, and how often it was found of how often it could have been.
class Sightings {
 public:
  /// What is larger in the image than `least_side_px` can be found.
  Sightings(const MapEvidence& evidence, const PlaceCluster& cluster, double least_side_px)
      : evidence_(evidence), place_(cluster.place), least_side_px_(least_side_px) {
    for (const MarkerView& view : cluster.views) {
      sets_.insert(view.frame_set);
      const ObservedFrameSet& set = frame_set_of(evidence, view.frame_set);
      periods_[set.capture].add(set.stamp);
    }
  }

  [[nodiscard]] const std::map<CaptureIndex, Period>& periods() const { return periods_; }
  [[nodiscard]] const std::set<FrameSetIndex>& sets() const { return sets_; }

  /// Whether the frame set would have shown the marker here, but did not.
  [[nodiscard]] bool empty_in(FrameSetIndex frame_set) const {
    return !sets_.contains(frame_set) &&
           has_clear_sight(evidence_, frame_set, place_, least_side_px_);
  }

  /// Share of frame sets that found it here of those that would have shown it, of those that
  /// `among` takes.
  template <typename Filter>
  [[nodiscard]] double found_share(const Filter& among) const {
    double found = 0;
    double missed = 0;
    for (const FrameSetIndex f : evidence_.frame_sets()) {
      if (!among(frame_set_of(evidence_, f))) continue;
      if (sets_.contains(f)) {
        ++found;
      } else if (empty_in(f)) {
        ++missed;
      }
    }
    return found / std::max(1.0, found + missed);
  }
  [[nodiscard]] double found_share_in_its_time() const {
    return found_share([&](const ObservedFrameSet& set) {
      const auto period = periods_.find(set.capture);
      return period != periods_.end() && period->second.holds(set.stamp);
    });
  }

 private:
  const MapEvidence& evidence_;
  SizedPlace place_;
  std::map<CaptureIndex, Period> periods_;  // by capture
  std::set<FrameSetIndex> sets_;
  double least_side_px_;
};

/// Whether two markers can hang at these places side by side.
bool prints_fit(const SizedPlace& a, const SizedPlace& b, double share) {
  const Eigen::Vector3d normal_a = a.world_from_marker.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d normal_b = b.world_from_marker.rotation * Eigen::Vector3d::UnitZ();
  const double half_angle = 0.5 * std::acos(std::clamp(normal_a.dot(normal_b), -1.0, 1.0));
  return (a.world_from_marker.translation - b.world_from_marker.translation).norm() >=
         share * std::cos(half_angle) * 0.5 * (a.size_m + b.size_m);
}

/// Which place the stamps call the later one, where they call one.
void tell_order(const MapEvidence& evidence, const Sightings& first, const Sightings& second,
                PlaceHistory& history, bool& shared) {
  std::set<bool> order;  // second later, as each capture that saw both tells
  for (const auto& [capture, a] : first.periods()) {
    const auto b = second.periods().find(capture);
    if (b == second.periods().end()) continue;
    shared = true;
    if (a.last < b->second.first) {
      order.insert(true);
    } else if (b->second.last < a.first) {
      order.insert(false);
    } else {
      history.interleaved = true;
    }
  }
  history.interleaved = history.interleaved || order.size() > 1;
  if (history.interleaved) return;
  if (!order.empty()) history.second_is_later = *order.begin();
  if (shared) return;
  // Captures on one clock follow each other; where they overlap, or count from the start of a
  // computer, clocks don't tell.
  Period a;
  Period b;
  const auto monotonic = [&](const auto& seen) {
    return evidence.observations().captures[seen.first].monotonic;
  };
  if (std::any_of(first.periods().begin(), first.periods().end(), monotonic) ||
      std::any_of(second.periods().begin(), second.periods().end(), monotonic)) {
    return;
  }
  for (const ObservedFrameSet& set : evidence.observations().frame_sets) {
    if (first.periods().contains(set.capture)) a.add(set.stamp);
    if (second.periods().contains(set.capture)) b.add(set.stamp);
  }
  if (a.last < b.first) history.second_is_later = true;
  if (b.last < a.first) history.second_is_later = false;
}

/// Whether a frame set belongs to the time in which only the other place can hold the marker.
bool in_time_of_other(const ObservedFrameSet& set, const Sightings& own, const Sightings& other,
                      const std::optional<bool>& other_is_later) {
  const auto of_own = own.periods().find(set.capture);
  const auto of_other = other.periods().find(set.capture);
  if (of_other == other.periods().end()) return false;
  if (of_own == own.periods().end() || !other_is_later) return of_own == own.periods().end();
  return *other_is_later ? set.stamp >= of_other->second.first : set.stamp <= of_other->second.last;
}

}  // namespace

Status HistoryOptions::check() const {
  return RangeCheck()
      .field("least_print_distance", least_print_distance, {0.7, 1})
      .field("least_found", least_found, {0.02, 0.5})
      .field("most_by_chance", most_by_chance, {1e-6, 0.05})
      .status();
}

PlaceHistory history_of(const MapEvidence& evidence, const PlaceCluster& first,
                        const PlaceCluster& second, const HistoryOptions& options) {
  constexpr double kMostFound = 0.9;  // nobody finds every marker every time
  const double least_side_px = std::min(smallest_side_px(first), smallest_side_px(second));
  const Sightings a(evidence, first, least_side_px);
  const Sightings b(evidence, second, least_side_px);
  PlaceHistory history;
  bool shared = false;
  tell_order(evidence, a, b, history, shared);
  history.at_once = std::any_of(a.sets().begin(), a.sets().end(), [&](FrameSetIndex frame_set) {
    return b.sets().contains(frame_set);
  });

  if (!history.interleaved) {
    // Looks at a place in the time of the other one.
    double by_chance = 1.0;
    const auto look = [&](const Sightings& own, const Sightings& other, bool other_is_first) {
      const double missed = 1.0 - std::min(kMostFound, own.found_share_in_its_time());
      std::optional<bool> other_is_later = history.second_is_later;
      if (other_is_later && other_is_first) other_is_later = !*other_is_later;
      for (const FrameSetIndex f : evidence.frame_sets()) {
        if (!in_time_of_other(frame_set_of(evidence, f), own, other, other_is_later)) continue;
        if (!own.empty_in(f)) continue;
        ++history.empty_looks;
        by_chance *= missed;
      }
    };
    look(a, b, false);
    look(b, a, true);
    if (by_chance < options.most_by_chance) {
      history.story =
          shared ? PlaceStory::moved_during_capture : PlaceStory::moved_between_captures;
      return history;
    }
  }
  const auto always = [](const ObservedFrameSet&) { return true; };
  const bool both_are_markers =
      std::min(a.found_share(always), b.found_share(always)) >= options.least_found;
  if (both_are_markers && prints_fit(first.place, second.place, options.least_print_distance)) {
    history.story = PlaceStory::twin;
  }
  return history;
}

}  // namespace waymark
