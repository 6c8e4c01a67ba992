#include "mapbuilder/upkeep/map_update.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "core/map/map_edit.h"
#include "core/map/marker_search.h"
#include "mapbuilder/upkeep/considered_marker.h"
#include "mapbuilder/upkeep/flipped_markers.h"
#include "mapbuilder/upkeep/joined_system.h"
#include "mapbuilder/upkeep/misfit.h"

namespace waymark {
namespace {

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

bool stands_among(const std::vector<ComparedMarker>& markers, const MarkerId& id) {
  return std::any_of(markers.begin(), markers.end(),
                     [&](const ComparedMarker& one) { return one.id == id; });
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

/// The largest of the turn's variances; infinite where unknown.
double turn_variance(const MapMarker& marker) {
  if (!marker.covariance_known()) return std::numeric_limits<double>::infinity();
  return marker.covariance.diagonal().tail<3>().maxCoeff();
}

/// Whether a marker's own move is doubtful: one view alone speaks for it; or it hangs where it hung
/// and is tilted only, as one that is seen flipped, by who knows its turn less than the map.
bool is_doubtful(const MapMarker& built, const MapMarker& old, const ComparedMarker& moved,
                 const Rigid3& old_from_round) {
  if (!built.verified) return true;
  const MovedLimits limits;
  if (is_shifted(moved, 1) && moved.distance_m > limits.distance_m) return false;
  const auto normal_of = [](const Rigid3& pose) -> Eigen::Vector3d {
    return pose.rotation * Eigen::Vector3d::UnitZ();
  };
  const double cosine =
      normal_of(old_from_round * built.world_from_marker).dot(normal_of(old.world_from_marker));
  return cosine < std::cos(limits.turn_rad) && turn_variance(built) > turn_variance(old);
}

class MapUpdater {
 public:
  MapUpdater(const MarkerMap& old_map, RoundParts& round, const UpdateOptions& options)
      : old_map_(old_map), round_(round), options_(options) {
    update_.map = old_map;
    known_.resize(old_map.submaps.size());
    for (std::size_t s = 0; s < options.systems.size() && s < known_.size(); ++s) {
      if (options.systems[s].markers() == 0) continue;
      for (const MapMarker& marker : old_map.submaps[s].markers) known_[s].ids.push_back(marker.id);
      known_[s].system = options.systems[s];
    }
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
    take_systems();
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
    reconsider_flips(part, updated);
    updated.misfit_sigmas = misfit_sigmas(updated.comparison.stayed);
    acquit(updated.comparison, updated.misfit_sigmas);
    if (tied.size() > 1) update_.joined_parts.push_back(part.submap);
    // Where sigmas don't hold, what the others' places tell holds even less.
    if (updated.misfit_sigmas > kPoorSigmas) known_[updated.old_submap] = {};
    adjust(part, updated, tied);
    mark_missing(part, updated);
    take_figures(part, updated.old_submap);
    update_.parts.push_back(std::move(updated));
    return true;
  }

  /// What the round's views leave open stands as the old map has it.
  void reconsider_flips(const RoundPart& part, UpdatedPart& updated) {
    const SubMap& old = old_map_.submaps[updated.old_submap];
    const Rigid3 round_from_old = updated.comparison.old_from_new.inverse();
    std::map<MarkerId, Rigid3> earlier;
    for (const ComparedMarker& marker : updated.comparison.moved) {
      // Where it hangs says enough.
      if (is_shifted(marker, 1) && marker.distance_m > MovedLimits{}.distance_m) continue;
      earlier[marker.id] = round_from_old * find_marker(old, marker.id)->world_from_marker;
    }
    const auto places = unflipped(round_, part, earlier);
    if (places.empty()) return;
    round_.place(part, places);
    auto again = compare_frames(round_.submap_of(part), old, options_.suspects);
    if (again) updated.comparison = *std::move(again);
  }

  void adjust(const RoundPart& part, const UpdatedPart& updated,
              const std::set<std::size_t>& tied) {
    const SubMap& round = round_.submap_of(part);
    std::set<MarkerId> released;
    std::vector<MarkerId> carrying;
    for (const auto* list : {&updated.comparison.stayed, &updated.comparison.suspects_in_place}) {
      for (const ComparedMarker& marker : *list) {
        if (is_shifted(marker, updated.misfit_sigmas) && find_marker(round, marker.id)->verified) {
          released.insert(marker.id);
          update_.shifted.push_back(marker);
        } else {
          carrying.push_back(marker.id);
        }
      }
    }
    const KnownMarkers seen =
        known_by_round(round_, part, updated.comparison.old_from_new, carrying);
    std::set<MarkerId> taken = taken_of(round, seen.ids, updated, tied);
    for (const ComparedMarker& marker : updated.comparison.moved) {
      if (taken.contains(marker.id)) released.insert(marker.id);
    }
    const JoinedMarkers joined =
        join(known_before(updated.old_submap, carrying, released), seen.marginal(taken));
    if (joined.covariances.empty()) return;  // nothing of it is determined: all is as it was
    place(joined, round, updated, taken);
    for (const ComparedMarker& marker : updated.comparison.moved) {
      if (taken.contains(marker.id)) update_.moved.push_back(marker);
    }
  }

  /// Which of the round's markers the map takes over; names the others.
  std::set<MarkerId> taken_of(const SubMap& round, const std::vector<MarkerId>& determined,
                              const UpdatedPart& updated, const std::set<std::size_t>& tied) {
    std::map<MarkerId, const ComparedMarker*> moved;
    for (const ComparedMarker& marker : updated.comparison.moved) moved[marker.id] = &marker;
    std::set<MarkerId> taken;
    for (const MapMarker& built : round.markers) {
      const auto known = submap_of_.find(built.id);
      const bool here = known == submap_of_.end() || known->second == updated.old_submap;
      if (!std::binary_search(determined.begin(), determined.end(), built.id)) {
        update_.not_taken.push_back(built.id);
      } else if (here &&
                 (!moved.contains(built.id) ||
                  !is_doubtful(built, *find_marker(old_map_.submaps[updated.old_submap], built.id),
                               *moved.at(built.id), updated.comparison.old_from_new))) {
        taken.insert(built.id);
      } else if (here) {
        seen_.insert(built.id);
        update_.doubted.push_back(*moved.at(built.id));
      } else if (!tied.contains(known->second) && built.verified) {
        taken.insert(built.id);
      } else if (!tied.contains(known->second)) {
        update_.not_taken.push_back(built.id);
      }
    }
    return taken;
  }

  /// What is known of a sub-map's markers but for the released ones; of independent ones those
  /// alone that carry the round tell anything.
  [[nodiscard]] KnownMarkers known_before(std::size_t submap, const std::vector<MarkerId>& carrying,
                                          const std::set<MarkerId>& released) const {
    const std::vector<MarkerId>& known = known_[submap].ids;
    std::set<MarkerId> keep(known.begin(), known.end());
    for (const MarkerId& id : released) keep.erase(id);
    if (!known.empty()) return known_[submap].marginal(keep);
    KnownMarkers independent;
    SubMap carriers;
    for (const MarkerId& id : carrying) {
      const MapMarker* marker = find_marker(update_.map.submaps[submap], id);
      if (marker == nullptr) continue;
      independent.ids.push_back(id);
      carriers.markers.push_back(*marker);
    }
    independent.system = independent_system(carriers);
    return independent;
  }

  /// Takes what is known of map and round together into the map.
  void place(const JoinedMarkers& joined, const SubMap& round, const UpdatedPart& updated,
             const std::set<MarkerId>& taken) {
    SubMap& submap = update_.map.submaps[updated.old_submap];
    const bool holds = updated.misfit_sigmas <= kPoorSigmas;
    for (std::size_t i = 0; i < joined.known.ids.size(); ++i) {
      const MarkerId& id = joined.known.ids[i];
      const MapMarker* here = find_marker(submap, id);
      const MapMarker* built = taken.contains(id) ? find_marker(round, id) : nullptr;
      MapMarker marker = built != nullptr ? with_history(*built, updated) : *here;
      marker.world_from_marker = joined.known.system.world_from_marker[i];
      marker.covariance = joined.covariances[i];
      if (built != nullptr && !holds) {
        marker.covariance *= updated.misfit_sigmas * updated.misfit_sigmas;
      }
      const bool stood = here != nullptr && !stands_among(updated.comparison.moved, id);
      consider(stood ? here : nullptr, updated.comparison.old_from_new, marker);
      put(marker, submap);
    }
    if (!known_[updated.old_submap].ids.empty()) known_[updated.old_submap] = joined.known;
  }

  /// A marker that was seen, with what is known of it from before, as far as it stood there.
  MapMarker with_history(MapMarker marker, const UpdatedPart& updated) {
    const auto known = submap_of_.find(marker.id);
    seen_.insert(marker.id);
    if (known == submap_of_.end()) {
      update_.appeared.push_back(marker.id);
    } else if (known->second != updated.old_submap) {
      update_.other_part.push_back(marker.id);
      std::erase_if(update_.map.submaps[known->second].markers,
                    [&](const MapMarker& one) { return one.id == marker.id; });
    } else if (stands_among(updated.comparison.moved, marker.id)) {
      marker.stated_size_m = find_marker(old_map_.submaps[known->second], marker.id)->stated_size_m;
    } else if (!stands_among(update_.shifted, marker.id)) {
      add_statistics(*find_marker(old_map_.submaps[known->second], marker.id), marker);
      update_.improved.push_back(marker.id);
    }
    return marker;
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

  /// What is known together of each sub-map as it is now.
  void take_systems() {
    for (const SubMap& submap : update_.map.submaps) {
      MarkerSystem& system = update_.systems.emplace_back();
      std::set<MarkerId> there;
      for (const MapMarker& marker : submap.markers) there.insert(marker.id);
      for (const KnownMarkers& known : known_) {
        const bool of_it = std::any_of(known.ids.begin(), known.ids.end(),
                                       [&](const MarkerId& id) { return there.contains(id); });
        if (!of_it) continue;
        const KnownMarkers here = known.marginal(there);
        if (here.ids.size() == there.size()) system = here.system;
      }
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
  RoundParts& round_;
  const UpdateOptions& options_;
  std::map<MarkerId, std::size_t> submap_of_;  ///< in the old map
  std::set<MarkerId> seen_;
  std::vector<KnownMarkers> known_;  ///< per old sub-map, by now; without markers: independent
  MapUpdate update_;
};

}  // namespace

Expected<MapUpdate> update_map(const MarkerMap& old_map, const std::string& name, RoundParts& round,
                               const UpdateOptions& options) {
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
