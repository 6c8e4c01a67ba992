#include "mapbuilder/diagnosis/marker_places.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/range.h"
#include "mapbuilder/diagnosis/view_placement.h"

namespace waymark {
namespace {

/// Largest angle (rad) under which the views' cameras see the place apart, or half of it.
double parallax_rad(const PlaceCluster& cluster) {
  const auto direction = [&](const MarkerView& view) {
    return (view.world_from_cam.translation - cluster.place.world_from_marker.translation)
        .normalized();
  };
  double largest = 0;
  const Eigen::Vector3d first = direction(cluster.views.front());
  for (const MarkerView& view : cluster.views) {
    largest = std::max(largest, std::acos(std::clamp(first.dot(direction(view)), -1.0, 1.0)));
  }
  return largest;
}

std::size_t frame_sets_of(const PlaceCluster& cluster) {
  std::set<FrameSetIndex> sets;
  for (const MarkerView& view : cluster.views) sets.insert(view.frame_set);
  return sets.size();
}

/// Places the marker by some views, then by all that the gate accepts there, until these stay the
/// same. nullopt when nearly none agree.
std::optional<PlaceCluster> settled(const MapEvidence& evidence,
                                    const std::vector<MarkerView>& views,
                                    std::vector<MarkerView> placing, const Rigid3& start) {
  constexpr int kMostRounds = 4;
  PlaceCluster cluster;
  cluster.place = {start, views.front().observation->size_m};
  for (int round = 0; round < kMostRounds; ++round) {
    const auto placed = refine_place(placing, cluster.place.world_from_marker, evidence.options());
    if (!placed) return std::nullopt;
    cluster.place.world_from_marker = placed->pose;
    const std::size_t before = cluster.views.size();
    cluster.views.clear();
    double cost = 0;
    for (const MarkerView& view : views) {
      const double s = misfit_sigmas2(view, cluster.place);
      if (s > evidence.gate_sigmas2()) continue;
      cluster.views.push_back(view);
      cost += s;
    }
    if (cluster.views.size() < 2) return std::nullopt;
    if (!placed->covariance) return std::nullopt;
    const double freedoms = 8.0 * static_cast<double>(cluster.views.size()) - 6.0;
    cluster.sigma_m = std::sqrt(placed->covariance->diagonal().head<3>().maxCoeff() *
                                std::max(1.0, cost / freedoms));
    if (cluster.views.size() == before) break;
    placing = cluster.views;
  }
  return cluster;
}

/// Grows a place from one hypothesis by the views nearest to it. A robust loss over all views would
/// settle between two places that lie near each other.
std::optional<PlaceCluster> grown_from(const MapEvidence& evidence,
                                       const std::vector<MarkerView>& views,
                                       const Rigid3& hypothesis) {
  constexpr std::size_t kNearest = 4;
  constexpr double kFarthest = 0.5;  // sides
  const SizedPlace place{hypothesis, views.front().observation->size_m};
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double distance = distance_px(views[i], place) / side_px(views[i]);
    if (distance < kFarthest) nearest.emplace_back(distance, i);
  }
  std::sort(nearest.begin(), nearest.end());
  std::vector<MarkerView> placing;
  for (std::size_t i = 0; i < std::min(kNearest, nearest.size()); ++i) {
    placing.push_back(views[nearest[i].second]);
  }
  return settled(evidence, views, placing, hypothesis);
}

/// Where the map has the marker, as far as views agree.
std::optional<PlaceCluster> home(const MapEvidence& evidence,
                                 const std::vector<MarkerView>& views) {
  const auto& place = evidence.place(views.front().marker);
  if (!place) return std::nullopt;
  std::vector<MarkerView> placing = views;
  std::erase_if(placing, [&](const MarkerView& view) {
    return misfit_sigmas2(view, *place) > evidence.gate_sigmas2();
  });
  return settled(evidence, views, placing, place->world_from_marker);
}

/// The place that most views agree on.
std::optional<PlaceCluster> best_place(const MapEvidence& evidence,
                                       const std::vector<MarkerView>& views) {
  constexpr std::size_t kMostSeeds = 16;
  const std::size_t seeds = std::min(views.size(), kMostSeeds);
  std::optional<PlaceCluster> best;
  for (std::size_t i = 0; i < seeds; ++i) {
    const MarkerView& view = views[i * views.size() / seeds];
    const std::vector<MarkerView> known = best ? best->views : std::vector<MarkerView>{};
    // A view that already agrees with the best place leads there again.
    if (std::any_of(known.begin(), known.end(),
                    [&](const MarkerView& v) { return v.index == view.index; })) {
      continue;
    }
    if (!view.observation->ippe) continue;
    for (const Rigid3& cam_from_marker : view.observation->ippe->cam_from_marker) {
      const auto grown = grown_from(evidence, views, view.world_from_cam * cam_from_marker);
      if (grown && (!best || grown->views.size() > best->views.size())) best = grown;
    }
  }
  return best;
}

}  // namespace

Status PlaceOptions::check() const {
  return RangeCheck()
      .field("least_views", least_views, {3, 50})
      .field("least_parallax_rad", least_parallax_rad, {0.008, 0.5})
      .field("least_separation", least_separation, {0.05, 2})
      .field("least_turn_rad", least_turn_rad, {0.1, 1.5})
      .status();
}

std::vector<PlaceCluster> find_places(const MapEvidence& evidence, std::vector<MarkerView> views,
                                      const PlaceOptions& options) {
  constexpr int kMostPlaces = 4;
  const auto least_views = static_cast<std::size_t>(options.least_views);
  std::vector<PlaceCluster> places;
  for (int i = 0; i < kMostPlaces && views.size() >= least_views; ++i) {
    auto found = i == 0 ? home(evidence, views) : std::nullopt;
    if (!found || found->views.size() < least_views) found = best_place(evidence, views);
    if (!found || found->views.size() < least_views) break;
    std::set<ObservationIndex> taken;
    for (const MarkerView& view : found->views) taken.insert(view.index);
    std::erase_if(views, [&](const MarkerView& view) { return taken.contains(view.index); });
    const bool apart = std::all_of(places.begin(), places.end(), [&](const PlaceCluster& p) {
      const Rigid3& a = p.place.world_from_marker;
      const Rigid3& b = found->place.world_from_marker;
      return (a.translation - b.translation).norm() >
                 options.least_separation * found->place.size_m ||
             angle_between_rad(a.rotation, b.rotation) > options.least_turn_rad;
    });
    if (apart && frame_sets_of(*found) >= least_views &&
        parallax_rad(*found) >= options.least_parallax_rad) {
      places.push_back(*found);
    }
  }
  std::stable_sort(places.begin(), places.end(), [](const PlaceCluster& a, const PlaceCluster& b) {
    return a.views.size() > b.views.size();
  });
  return places;
}

}  // namespace waymark
