#include "mapbuilder/upkeep/missing_markers.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/median.h"
#include "core/base/parallel.h"
#include "core/marker/marker_outline.h"
#include "mapbuilder/diagnosis/clear_sight.h"

namespace waymark {
namespace {

/// Nobody finds every marker every time.
constexpr double kLeastMissed = 0.1;

/// Frame sets that look at a place, and how many of them found the marker there.
struct Looks {
  int found = 0;
  int empty = 0;
};

/// How the round sees: what it can read, and how far.
class Sight {
 public:
  Sight(const RoundParts& round, const RoundPart& part)
      : evidence_(round.prepared(), round.estimate(), part.component, round.options()) {
    std::vector<double> sides_px;
    for (const FrameSetIndex f : evidence_.frame_sets()) {
      for (const MarkerView& view : evidence_.views_in(f)) {
        // What the gate rejects there is no absence either.
        seen_.insert({view.marker, f});
        if (!view.accepted) continue;
        sides_px.push_back(side_px(view));
        const auto& rig = evidence_.world_from_rig(f);
        const auto& place = evidence_.place(view.marker);
        if (rig && place) reach_m_ = std::max(reach_m_, distance_m(*rig, *place));
      }
    }
    if (!sides_px.empty()) side_px_ = median(sides_px);
  }

  [[nodiscard]] const MapEvidence& evidence() const { return evidence_; }

  /// Looks at a place of the estimate's world; `marker`: the one to be found, if ever it was seen.
  [[nodiscard]] Looks at(const SizedPlace& place, std::optional<MarkerIndex> marker) const {
    Looks looks;
    for (const FrameSetIndex f : evidence_.frame_sets()) {
      const auto& rig = evidence_.world_from_rig(f);
      if (!rig || distance_m(*rig, place) > reach_m_) continue;
      if (!has_clear_sight(evidence_, f, place, side_px_)) continue;
      const bool found = marker && seen_.contains({*marker, f});
      ++(found ? looks.found : looks.empty);
    }
    return looks;
  }

 private:
  static double distance_m(const Rigid3& rig, const SizedPlace& place) {
    return (rig.translation - place.world_from_marker.translation).norm();
  }

  MapEvidence evidence_;
  std::set<std::pair<MarkerIndex, FrameSetIndex>> seen_;
  double side_px_ = 0;
  double reach_m_ = 0;
};

/// The share of looks by which the round's own markers are missed.
double missed_share(const Sight& sight, int threads) {
  const std::vector<MarkerIndex>& markers = sight.evidence().markers();
  std::vector<Looks> each(markers.size());
  parallel_for(markers.size(), threads, [&](std::size_t i) {
    if (const auto& place = sight.evidence().place(markers[i])) {
      each[i] = sight.at(*place, markers[i]);
    }
  });
  double found = 0;
  double empty = 0;
  for (const Looks& looks : each) {
    found += looks.found;
    empty += looks.found > 0 ? looks.empty : 0;
  }
  return found + empty > 0 ? std::max(kLeastMissed, empty / (found + empty)) : 1.0;
}

}  // namespace

std::vector<MissingMarker> find_missing(const RoundParts& round, const RoundPart& part,
                                        const Rigid3& round_from_old,
                                        const std::vector<const MapMarker*>& markers) {
  if (markers.empty()) return {};
  const Sight sight(round, part);
  const int threads = round.options().threads;
  const double missed = missed_share(sight, threads);
  const Rigid3 estimate_from_old = part.world_from_estimate.inverse() * round_from_old;
  std::vector<int> empty(markers.size(), 0);
  parallel_for(markers.size(), threads, [&](std::size_t i) {
    const SizedPlace place{estimate_from_old * markers[i]->world_from_marker, markers[i]->size_m};
    empty[i] = sight.at(place, round.index_of(markers[i]->id)).empty;
  });
  std::vector<MissingMarker> missing;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (std::pow(missed, empty[i]) < kMissedByChance) missing.push_back({markers[i]->id, empty[i]});
  }
  std::sort(missing.begin(), missing.end(),
            [](const MissingMarker& a, const MissingMarker& b) { return a.id < b.id; });
  return missing;
}

}  // namespace waymark
