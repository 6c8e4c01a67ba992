#include "mapbuilder/upkeep/map_update.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "core/base/median.h"
#include "core/map/map_edit.h"
#include "core/map/marker_search.h"
#include "mapbuilder/upkeep/prior_adjustment.h"

namespace waymark {
namespace {

/// Beyond so many sigmas a marker that stayed no longer stands where it stood.
constexpr double kShiftedSigmas = 5.0;
/// Fewer markers that stayed don't tell whether sigmas hold.
constexpr std::size_t kFewestForMisfit = 5;

std::optional<double> sigmas_off(const ComparedMarker& marker) {
  if (!marker.sigma_m || !(*marker.sigma_m > 0)) return std::nullopt;
  return marker.distance_m / *marker.sigma_m;
}

/// Median distance of those that stayed against what three normal coordinates would give, at least
/// 1: half of the markers may have been pressed on again.
double misfit_sigmas(const std::vector<ComparedMarker>& stayed) {
  std::vector<double> squares;
  for (const ComparedMarker& marker : stayed) {
    if (const auto off = sigmas_off(marker)) squares.push_back(*off * *off);
  }
  if (squares.size() < kFewestForMisfit) return 1.0;
  return std::max(1.0, std::sqrt(median(squares) / kMedianOfChi2_3));
}

/// Where sigmas don't hold, what is within five of them at the misfit that all show has not moved.
void acquit(UpdatedPart& part) {
  FrameComparison& comparison = part.comparison;
  const auto acquitted = [&](const ComparedMarker& marker) {
    const auto off = sigmas_off(marker);
    return off && *off <= kShiftedSigmas * part.misfit_sigmas &&
           marker.turn_rad <= MovedLimits{}.turn_rad;
  };
  std::copy_if(comparison.moved.begin(), comparison.moved.end(),
               std::back_inserter(comparison.stayed), acquitted);
  std::erase_if(comparison.moved, acquitted);
  std::sort(comparison.stayed.begin(), comparison.stayed.end(),
            [](const ComparedMarker& a, const ComparedMarker& b) { return a.id < b.id; });
}

double pooled_rms(double a, double count_a, double b, double count_b) {
  const double count = count_a + count_b;
  return count == 0 ? 0.0 : std::sqrt((a * a * count_a + b * b * count_b) / count);
}

/// Observations of a sub-map's markers, accepted and all.
std::pair<double, double> observations_of(const SubMap& submap) {
  std::pair<double, double> counts{0, 0};
  for (const MapMarker& marker : submap.markers) {
    counts.first += marker.observations;
    counts.second += marker.observations + marker.rejected;
  }
  return counts;
}

/// A marker that stood there before, with what the round saw of it.
void add_statistics(const MapMarker& before, MapMarker& marker) {
  marker.rms_px =
      pooled_rms(before.rms_px, before.observations, marker.rms_px, marker.observations);
  marker.observations += before.observations;
  marker.rejected += before.rejected;
  marker.verified = marker.verified || before.verified;
  marker.stated_size_m = before.stated_size_m;
}

void put(const MapMarker& marker, SubMap& submap) {
  const auto at =
      std::lower_bound(submap.markers.begin(), submap.markers.end(), marker.id,
                       [](const MapMarker& one, const MarkerId& id) { return one.id < id; });
  if (at != submap.markers.end() && at->id == marker.id) {
    *at = marker;
  } else {
    submap.markers.insert(at, marker);
  }
}

class MapUpdater {
 public:
  MapUpdater(const MarkerMap& old_map, const RoundParts& round, const UpdateOptions& options)
      : old_map_(old_map), round_(round), options_(options) {
    update_.map = old_map;
    for (std::size_t s = 0; s < old_map.submaps.size(); ++s) {
      for (const MapMarker& marker : old_map.submaps[s].markers) submap_of_[marker.id] = s;
    }
  }

  /// False where nothing of the round could be laid into the old map.
  bool take_round() {
    std::vector<const RoundPart*> untied;
    for (const RoundPart& part : round_.parts()) {
      if (!take_part(part)) untied.push_back(&part);
    }
    if (update_.parts.empty()) return false;
    for (const RoundPart* part : untied) take_untied(*part);
    return true;
  }

  [[nodiscard]] MapUpdate finish() {
    name_unseen();
    std::erase_if(update_.map.submaps, [](const SubMap& one) { return one.markers.empty(); });
    sort_map(update_.map);
    take_provenance();
    for (auto* ids : {&update_.improved, &update_.other_part, &update_.appeared, &update_.unseen,
                      &update_.not_taken}) {
      std::sort(ids->begin(), ids->end());
    }
    return std::move(update_);
  }

 private:
  /// Lays a part into the old sub-map that most of its markers agree with; false: into none.
  bool take_part(const RoundPart& part) {
    const SubMap& built = round_.submap_of(part);
    UpdatedPart updated;
    std::set<std::size_t> tied;
    for (std::size_t s = 0; s < old_map_.submaps.size(); ++s) {
      auto comparison = compare_frames(built, old_map_.submaps[s], options_.suspects);
      if (!comparison) continue;
      tied.insert(s);
      if (comparison->stayed.size() <= updated.comparison.stayed.size()) continue;
      updated.comparison = *std::move(comparison);
      updated.old_submap = s;
    }
    if (tied.empty()) return false;
    updated.round_submap = part.submap;
    updated.misfit_sigmas = misfit_sigmas(updated.comparison.stayed);
    acquit(updated);
    if (tied.size() > 1) update_.joined_parts.push_back(part.submap);
    adjust(part, updated, tied);
    mark_missing(part, updated);
    take_figures(part, updated.old_submap);
    update_.parts.push_back(std::move(updated));
    return true;
  }

  /// Whether a marker that stayed lies off by more than chance.
  static bool is_shifted(const ComparedMarker& marker, double misfit) {
    const auto off = sigmas_off(marker);
    return off && *off > kShiftedSigmas * misfit;
  }

  void adjust(const RoundPart& part, const UpdatedPart& updated,
              const std::set<std::size_t>& tied) {
    const SubMap& old = old_map_.submaps[updated.old_submap];
    const SubMap& round = round_.submap_of(part);
    std::vector<ComparedMarker> stayed = updated.comparison.stayed;
    stayed.insert(stayed.end(), updated.comparison.suspects_in_place.begin(),
                  updated.comparison.suspects_in_place.end());
    std::vector<const MapMarker*> known;
    std::set<MarkerId> shifted;
    for (const ComparedMarker& marker : stayed) {
      if (is_shifted(marker, updated.misfit_sigmas) && find_marker(round, marker.id)->verified) {
        shifted.insert(marker.id);
        update_.shifted.push_back(marker);
      } else {
        known.push_back(find_marker(old, marker.id));
      }
    }
    const auto places = adjust_with_priors(round_, part, updated.comparison.old_from_new, known);
    std::map<MarkerId, ComparedMarker> moved;
    for (const ComparedMarker& marker : updated.comparison.moved) moved.emplace(marker.id, marker);
    const double scale = updated.misfit_sigmas * updated.misfit_sigmas;
    for (const MapMarker& built : round.markers) {
      const auto place = places.find(built.id);
      if (place == places.end()) {
        update_.not_taken.push_back(built.id);
        continue;
      }
      MapMarker marker = built;
      marker.world_from_marker = place->second.world_from_marker;
      marker.covariance = scale * place->second.covariance;
      const auto gone_to = moved.find(built.id);
      take_marker(marker, updated.old_submap, tied,
                  gone_to == moved.end() ? nullptr : &gone_to->second, shifted.contains(built.id));
    }
  }

  void take_marker(MapMarker marker, std::size_t submap, const std::set<std::size_t>& tied,
                   const ComparedMarker* moved, bool is_shifted) {
    const auto known = submap_of_.find(marker.id);
    seen_.insert(marker.id);
    if (known == submap_of_.end()) {
      update_.appeared.push_back(marker.id);
    } else if (known->second != submap) {
      // Of a part that the round ties to this one: it stays there.
      if (tied.contains(known->second)) return;
      if (!marker.verified) {
        update_.not_taken.push_back(marker.id);
        return;
      }
      update_.other_part.push_back(marker.id);
      std::erase_if(update_.map.submaps[known->second].markers,
                    [&](const MapMarker& one) { return one.id == marker.id; });
    } else if (moved != nullptr && !marker.verified) {
      update_.doubted.push_back(*moved);
      return;
    } else if (moved != nullptr) {
      update_.moved.push_back(*moved);
    } else if (!is_shifted) {
      add_statistics(*find_marker(old_map_.submaps[submap], marker.id), marker);
      update_.improved.push_back(marker.id);
    }
    put(marker, update_.map.submaps[submap]);
  }

  void mark_missing(const RoundPart& part, const UpdatedPart& updated) {
    std::vector<const MapMarker*> absent;
    for (const MarkerId& id : updated.comparison.vanished) {
      absent.push_back(find_marker(old_map_.submaps[updated.old_submap], id));
    }
    SubMap& submap = update_.map.submaps[updated.old_submap];
    for (const MissingMarker& missing :
         find_missing(round_, part, updated.comparison.old_from_new.inverse(), absent)) {
      update_.missing.push_back(missing);
      for (MapMarker& marker : submap.markers) {
        if (marker.id == missing.id) marker.verified = false;
      }
      if (options_.drop_unseen) {
        std::erase_if(submap.markers,
                      [&](const MapMarker& marker) { return marker.id == missing.id; });
      }
    }
  }

  void take_figures(const RoundPart& part, std::size_t old_submap) {
    const SubMap& built = round_.submap_of(part);
    SubMap& submap = update_.map.submaps[old_submap];
    const auto [accepted, all] = observations_of(old_map_.submaps[old_submap]);
    const auto [more_accepted, more_all] = observations_of(built);
    submap.rms_px = pooled_rms(submap.rms_px, accepted, built.rms_px, more_accepted);
    submap.rms_all_px = pooled_rms(submap.rms_all_px, all, built.rms_all_px, more_all);
    submap.frame_sets += built.frame_sets;
  }

  /// A part that no three markers of the old map tie to it.
  void take_untied(const RoundPart& part) {
    SubMap fresh = round_.submap_of(part);
    std::erase_if(fresh.markers, [&](const MapMarker& marker) {
      if (!submap_of_.contains(marker.id)) return false;
      if (seen_.insert(marker.id).second) update_.not_taken.push_back(marker.id);
      return true;
    });
    if (fresh.markers.empty()) return;
    for (const MapMarker& marker : fresh.markers) update_.appeared.push_back(marker.id);
    update_.map.submaps.push_back(std::move(fresh));
  }

  void name_unseen() {
    std::set<MarkerId> missing;
    for (const MissingMarker& one : update_.missing) missing.insert(one.id);
    for (const auto& [id, submap] : submap_of_) {
      if (!seen_.contains(id) && !missing.contains(id)) update_.unseen.push_back(id);
    }
  }

  void take_provenance() {
    MarkerMap& map = update_.map;
    const MarkerMap& round = round_.result().map;
    map.builder_version = round.builder_version;
    map.capture_fingerprints.insert(map.capture_fingerprints.end(),
                                    round.capture_fingerprints.begin(),
                                    round.capture_fingerprints.end());
    std::sort(map.capture_fingerprints.begin(), map.capture_fingerprints.end());
    // A map of several rigs is none's.
    if (map.rig_fingerprint != round.rig_fingerprint) map.rig_fingerprint.clear();
  }

  const MarkerMap& old_map_;
  const RoundParts& round_;
  const UpdateOptions& options_;
  std::map<MarkerId, std::size_t> submap_of_;  ///< in the old map
  std::set<MarkerId> seen_;
  MapUpdate update_;
};

}  // namespace

Expected<MapUpdate> update_map(const MarkerMap& old_map, const std::string& name,
                               const RoundParts& round, const UpdateOptions& options) {
  for (const ObservedCapture& capture : round.observations().captures) {
    if (!std::binary_search(old_map.capture_fingerprints.begin(),
                            old_map.capture_fingerprints.end(), capture.fingerprint)) {
      continue;
    }
    return fail(ErrorKind::bad_data,
                "{}: {} went into it already: what it saw would count twice; name new captures",
                name, capture.name);
  }
  MapUpdater updater(old_map, round, options);
  if (!updater.take_round()) {
    return fail(Cause::other_place,
                "{}: the round can't be laid into it: no 3 markers of both stand alike against "
                "each other; see that it is a map of this building, and that the round sees some "
                "of its markers together",
                name);
  }
  return updater.finish();
}

}  // namespace waymark
