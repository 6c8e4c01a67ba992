#include "mapbuilder/upkeep/map_difference.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/median.h"
#include "core/geometry/alignment.h"
#include "core/map/map_file.h"
#include "core/map/marker_search.h"

namespace waymark {
namespace {

/// Ratios of shorter lengths tell of the markers' errors, not of scale (m).
constexpr double kShortest_m = 0.1;
/// Sizes differ beyond 0.1 %, or 0.2 mm: what a ruler can't tell on paper is no other size.
constexpr double kSameSize = 0.001;
constexpr double kSameSize_m = 0.0002;

using Points = std::vector<Eigen::Vector3d>;

/// Positions of the markers of both, in the same order.
std::pair<Points, Points> common_positions(const SubMap& a, const SubMap& b) {
  std::pair<Points, Points> positions;
  for (const MapMarker& marker : a.markers) {
    const MapMarker* other = find_marker(b, marker.id);
    if (other == nullptr) continue;
    positions.first.push_back(marker.world_from_marker.translation);
    positions.second.push_back(other->world_from_marker.translation);
  }
  return positions;
}

/// Median ratio of lengths in the old one to those in the new one: between each marker and those
/// half and a third of the way round. As long as seven of ten markers stayed, most pairs did.
std::optional<double> median_length_ratio(const Points& in_new, const Points& in_old) {
  std::vector<double> ratios;
  const std::size_t count = in_new.size();
  for (const std::size_t step : {count / 2, count / 3}) {
    if (step == 0) continue;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = (i + step) % count;
      const double now_m = (in_new[i] - in_new[j]).norm();
      const double then_m = (in_old[i] - in_old[j]).norm();
      if (now_m > kShortest_m && then_m > kShortest_m) ratios.push_back(then_m / now_m);
    }
  }
  if (ratios.empty()) return std::nullopt;
  return median(ratios);
}

void scale_positions(double scale, Matrix6d& covariance) {
  covariance.topLeftCorner<3, 3>() *= scale * scale;
  covariance.topRightCorner<3, 3>() *= scale;
  covariance.bottomLeftCorner<3, 3>() *= scale;
}

SubMap scaled(SubMap submap, double scale) {
  for (MapMarker& marker : submap.markers) {
    marker.world_from_marker.translation *= scale;
    scale_positions(scale, marker.covariance);
    scale_positions(scale, marker.covariance_metric);
    marker.modes.topRows<3>() *= static_cast<float>(scale);
  }
  return submap;
}

/// Scale and its sigma by the markers that stayed.
void take_scale(const SubMap& now, const SubMap& then, SubMapDifference& difference) {
  Points x_now;
  Points x_then;
  for (const ComparedMarker& marker : difference.comparison.stayed) {
    x_now.push_back(find_marker(now, marker.id)->world_from_marker.translation);
    x_then.push_back(find_marker(then, marker.id)->world_from_marker.translation);
  }
  const auto fit = align_points(x_now, x_then, true);
  if (!fit) return;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& x : x_now) centre += x / static_cast<double>(x_now.size());
  double misfit = 0;
  double spread = 0;
  for (std::size_t i = 0; i < x_now.size(); ++i) {
    misfit += (*fit * x_now[i] - x_then[i]).squaredNorm();
    spread += (x_now[i] - centre).squaredNorm();
  }
  const auto freedoms = 3.0 * static_cast<double>(x_now.size()) - 7.0;
  difference.old_from_new_scale = fit->scale;
  difference.scale_sigma = std::sqrt(misfit / freedoms / spread);
}

void take_world(const SubMap& now, SubMapDifference& difference) {
  const Rigid3& old_from_new = difference.comparison.old_from_new;
  const double scale = difference.compared_at_scale;
  difference.world_turn_rad =
      angle_between_rad(old_from_new.rotation, Eigen::Quaterniond::Identity());
  for (const ComparedMarker& marker : difference.comparison.stayed) {
    const Eigen::Vector3d& x = find_marker(now, marker.id)->world_from_marker.translation;
    difference.world_shift_m =
        std::max(difference.world_shift_m, (old_from_new * (scale * x) - x).norm());
  }
}

std::optional<double> median_sigma_m(const SubMap& submap) {
  std::vector<double> sigmas_m;
  for (const MapMarker& marker : submap.markers) {
    if (!marker.covariance_known()) continue;
    sigmas_m.push_back(std::sqrt(std::max(0.0, marker.covariance.topLeftCorner<3, 3>().trace())));
  }
  if (sigmas_m.empty()) return std::nullopt;
  return median(sigmas_m);
}

/// nullopt where they share too few markers that agree.
std::optional<SubMapDifference> compare_submaps(const SubMap& then, const SubMap& now) {
  const auto [x_now, x_then] = common_positions(now, then);
  SubMapDifference difference;
  difference.common = x_now.size();
  const std::size_t fewest = std::min(difference.common, kFewestThatAgree);
  const bool lone = now.markers.size() == 1 || then.markers.size() == 1;
  if (fewest < 2 && !(fewest == 1 && lone)) return std::nullopt;
  auto comparison = compare_frames(now, then, {}, {}, fewest);
  if (const auto ratio = median_length_ratio(x_now, x_then)) {
    auto at_ratio = compare_frames(scaled(now, *ratio), then, {}, {}, fewest);
    if (at_ratio && (!comparison || at_ratio->stayed.size() > comparison->stayed.size())) {
      comparison = std::move(at_ratio);
      difference.compared_at_scale = *ratio;
    }
  }
  if (!comparison) return std::nullopt;
  difference.comparison = *std::move(comparison);
  difference.old_frame = then.frame;
  difference.new_frame = now.frame;
  difference.old_z_is_up = then.z_is_up;
  difference.new_z_is_up = now.z_is_up;
  difference.old_median_sigma_m = median_sigma_m(then);
  difference.new_median_sigma_m = median_sigma_m(now);
  take_scale(now, then, difference);
  take_world(now, difference);
  return difference;
}

/// Takes those out of appeared and vanished that are one marker under two names.
void take_renamed(const MarkerMap& old_map, const MarkerMap& new_map, MapDifference& difference) {
  const MovedLimits limits;
  std::set<MarkerId> appeared(difference.appeared.begin(), difference.appeared.end());
  std::set<MarkerId> vanished(difference.vanished.begin(), difference.vanished.end());
  for (const SubMapDifference& pair : difference.submaps) {
    const SubMap& then = old_map.submaps[pair.old_submap];
    const SubMap& now = new_map.submaps[pair.new_submap];
    const double scale = pair.compared_at_scale;
    for (const MarkerId& gone : pair.comparison.vanished) {
      if (!vanished.contains(gone)) continue;
      const MapMarker& before = *find_marker(then, gone);
      for (const MarkerId& fresh : pair.comparison.appeared) {
        if (!appeared.contains(fresh) || fresh.family != gone.family) continue;
        const MapMarker& after = *find_marker(now, fresh);
        Rigid3 pose = after.world_from_marker;
        pose.translation *= scale;
        pose = pair.comparison.old_from_new * pose;
        const bool in_place =
            (pose.translation - before.world_from_marker.translation).norm() <= limits.distance_m &&
            angle_between_rad(pose.rotation, before.world_from_marker.rotation) <= limits.turn_rad;
        if (!in_place) continue;
        difference.renamed.push_back({gone, fresh});
        vanished.erase(gone);
        appeared.erase(fresh);
        break;
      }
    }
  }
  std::sort(difference.renamed.begin(), difference.renamed.end(),
            [](const RenamedMarker& a, const RenamedMarker& b) { return a.from < b.from; });
  difference.appeared.assign(appeared.begin(), appeared.end());
  difference.vanished.assign(vanished.begin(), vanished.end());
}

bool differs_in_size(const MapMarker& a, const MapMarker& b) {
  return std::abs(a.size_m - b.size_m) > std::max(kSameSize_m, kSameSize * a.size_m);
}

/// What a marker of both maps has of its own, and whether it stands in two that were compared.
void take_common_markers(const MarkerMap& old_map, const MarkerMap& new_map,
                         MapDifference& difference) {
  std::map<MarkerId, FoundMarker> before;
  for (std::size_t s = 0; s < old_map.submaps.size(); ++s) {
    for (const MapMarker& marker : old_map.submaps[s].markers) before[marker.id] = {s, &marker};
  }
  std::set<std::pair<std::size_t, std::size_t>> compared;
  for (const SubMapDifference& pair : difference.submaps) {
    compared.emplace(pair.old_submap, pair.new_submap);
  }
  std::set<MarkerId> gone;
  for (const auto& [id, found] : before) gone.insert(id);
  for (std::size_t s = 0; s < new_map.submaps.size(); ++s) {
    for (const MapMarker& marker : new_map.submaps[s].markers) {
      const auto known = before.find(marker.id);
      if (known == before.end()) {
        difference.appeared.push_back(marker.id);
        continue;
      }
      gone.erase(marker.id);
      const MapMarker& then = *known->second.marker;
      if (differs_in_size(then, marker)) {
        difference.resized.push_back({marker.id, then.size_m, marker.size_m});
      }
      if (marker.verified && !then.verified) difference.verified.push_back(marker.id);
      if (!marker.verified && then.verified) difference.unverified.push_back(marker.id);
      if (!compared.contains({known->second.submap, s})) {
        difference.not_compared.push_back(marker.id);
      }
    }
  }
  difference.vanished.assign(gone.begin(), gone.end());
  for (auto* list : {&difference.appeared, &difference.verified, &difference.unverified,
                     &difference.not_compared}) {
    std::sort(list->begin(), list->end());
  }
  std::sort(difference.resized.begin(), difference.resized.end(),
            [](const ResizedMarker& a, const ResizedMarker& b) { return a.id < b.id; });
}

}  // namespace

Expected<MapDifference> difference_of(const MarkerMap& old_map, const std::string& old_name,
                                      const MarkerMap& new_map, const std::string& new_name) {
  MapDifference difference;
  difference.old_hash = content_hash(old_map);
  difference.new_hash = content_hash(new_map);
  difference.old_markers = marker_ids(old_map).size();
  difference.new_markers = marker_ids(new_map).size();
  difference.old_submaps = old_map.submaps.size();
  difference.new_submaps = new_map.submaps.size();
  difference.several_families = old_map.several_families() || new_map.several_families() ||
                                old_map.families().only() != new_map.families().only();
  for (std::size_t n = 0; n < new_map.submaps.size(); ++n) {
    for (std::size_t o = 0; o < old_map.submaps.size(); ++o) {
      auto compared = compare_submaps(old_map.submaps[o], new_map.submaps[n]);
      if (!compared) continue;
      compared->old_submap = o;
      compared->new_submap = n;
      difference.submaps.push_back(*std::move(compared));
    }
  }
  take_common_markers(old_map, new_map, difference);
  if (difference.submaps.empty()) {
    const std::size_t common = difference.not_compared.size();
    return fail(
        ErrorKind::bad_data,
        "{}, {}: can't be compared: of {} and {} markers {} are in both, and of these no {} "
        "stand alike against each other; are they maps of one place?",
        old_name, new_name, difference.old_markers, difference.new_markers, common,
        kFewestThatAgree);
  }
  take_renamed(old_map, new_map, difference);
  return difference;
}

}  // namespace waymark
