#include "mapbuilder/diagnosis/marker_places.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/marker/marker_geometry.h"
#include "mapbuilder/diagnosis/view_placement.h"

namespace waymark {
namespace {

/// Largest angle (rad) under which the views' cameras see the place apart.
double parallax_rad(std::span<const MarkerView> views, const SizedPlace& place) {
  double largest = 0;
  const auto direction = [&](const MarkerView& view) {
    return (view.world_from_cam.translation - place.world_from_marker.translation).normalized();
  };
  // From the first view alone: half of the true largest at worst.
  const Eigen::Vector3d first = direction(views.front());
  for (const MarkerView& view : views) {
    largest = std::max(largest, std::acos(std::clamp(first.dot(direction(view)), -1.0, 1.0)));
  }
  return largest;
}

/// A place and the views that the gate accepts there.
std::optional<PlaceCluster> best_place(const MapEvidence& evidence,
                                       std::span<const MarkerView> views) {
  constexpr int kRounds = 2;
  const double gate = evidence.options().gate.reject_sigmas;
  PlaceCluster cluster;
  std::vector<MarkerView> placing(views.begin(), views.end());
  for (int round = 0; round < kRounds; ++round) {
    const auto placed = place_at_size(placing, 1.0, evidence.options());
    if (!placed) return std::nullopt;
    cluster.place = {placed->best.pose, views.front().observation->size_m};
    cluster.views.clear();
    double cost = 0;
    for (const MarkerView& view : views) {
      const double s = misfit_sigmas2(view, cluster.place);
      if (s > gate * gate) continue;
      cluster.views.push_back(view);
      cost += s;
    }
    if (cluster.views.empty()) return std::nullopt;
    const double freedoms = std::max(1.0, 8.0 * static_cast<double>(cluster.views.size()) - 6.0);
    cluster.sigma_m = std::sqrt(placed->best.covariance.diagonal().head<3>().maxCoeff() *
                                std::max(1.0, cost / freedoms));
    placing = cluster.views;
  }
  return cluster;
}

/// Stamps of one capture at which a place was seen.
struct Period {
  Stamp first = Stamp::max();
  Stamp last = Stamp::min();
  void add(Stamp stamp) {
    first = std::min(first, stamp);
    last = std::max(last, stamp);
  }
};

std::map<int, Period> periods_of(const ObservationTable& table, const PlaceCluster& cluster) {
  std::map<int, Period> periods;
  for (const MarkerView& view : cluster.views) {
    const TableFrameSet& set =
        table.frame_sets[static_cast<std::size_t>(view.observation->frame_set)];
    periods[set.capture].add(set.stamp);
  }
  return periods;
}

/// Whether a camera of the frame set looks at the place as well as at `seen`'s smallest view, and
/// sees another mapped marker in the same image.
bool looks_at(const MapEvidence& evidence, int frame_set, const SizedPlace& place,
              double least_side_px) {
  constexpr double kLeastCosine = 0.5;  // within 60° of the marker's normal
  const ObservationTable& table = evidence.table();
  const auto& world_from_rig = evidence.world_from_rig(frame_set);
  if (!world_from_rig) return false;
  const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(frame_set)];
  const Rig& rig = table.rigs[static_cast<std::size_t>(set.rig)];
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const CameraModel& model = rig.cameras[c].model;
    const Rigid3 cam_from_marker =
        (*world_from_rig * rig.cameras[c].rig_from_cam).inverse() * place.world_from_marker;
    const Eigen::Vector3d towards_camera = -cam_from_marker.translation.normalized();
    if ((cam_from_marker.rotation * Eigen::Vector3d::UnitZ()).dot(towards_camera) < kLeastCosine) {
      continue;
    }
    ImageCorners corners;
    bool inside = true;
    const auto in_marker = marker_corners(place.size_m);
    for (std::size_t i = 0; i < 4 && inside; ++i) {
      const auto pixel = model.project(cam_from_marker * in_marker[i]);
      inside = pixel && model.in_image(*pixel);
      if (inside) corners[i] = *pixel;
    }
    if (!inside || std::sqrt(area_px2(corners)) < least_side_px) continue;
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      if (table.observations[set.first_observation + i].camera == static_cast<int>(c)) return true;
    }
  }
  return false;
}

double smallest_side_px(const PlaceCluster& a, const PlaceCluster& b) {
  double smallest = 1e9;
  for (const PlaceCluster* cluster : {&a, &b}) {
    for (const MarkerView& view : cluster->views) smallest = std::min(smallest, side_px(view));
  }
  return smallest;
}

}  // namespace

std::vector<PlaceCluster> find_places(const MapEvidence& evidence, std::vector<MarkerView> views,
                                      const PlaceOptions& options) {
  constexpr int kMostPlaces = 4;
  std::vector<PlaceCluster> places;
  for (int i = 0; i < kMostPlaces; ++i) {
    if (views.size() < static_cast<std::size_t>(options.least_views)) break;
    const auto found = best_place(evidence, views);
    if (!found || found->views.size() < static_cast<std::size_t>(options.least_views)) break;
    const auto taken = [&](const MarkerView& view) {
      return std::any_of(found->views.begin(), found->views.end(), [&](const MarkerView& other) {
        return other.observation == view.observation;
      });
    };
    std::erase_if(views, taken);
    const bool apart = std::all_of(places.begin(), places.end(), [&](const PlaceCluster& p) {
      return (p.place.world_from_marker.translation - found->place.world_from_marker.translation)
                 .norm() > options.least_separation * found->place.size_m;
    });
    if (apart && parallax_rad(found->views, found->place) >= options.least_parallax_rad) {
      places.push_back(*found);
    }
  }
  std::stable_sort(places.begin(), places.end(), [](const PlaceCluster& a, const PlaceCluster& b) {
    return a.views.size() > b.views.size();
  });
  return places;
}

PlaceHistory history_of(const MapEvidence& evidence, const PlaceCluster& first,
                        const PlaceCluster& second) {
  constexpr int kLeastEmptyLooks = 3;
  const ObservationTable& table = evidence.table();
  const auto first_periods = periods_of(table, first);
  const auto second_periods = periods_of(table, second);

  PlaceHistory history;
  bool shared = false;
  std::set<bool> order;  // second later, as each capture that saw both tells
  for (const auto& [capture, a] : first_periods) {
    const auto b = second_periods.find(capture);
    if (b == second_periods.end()) continue;
    shared = true;
    if (a.last < b->second.first) {
      order.insert(true);
    } else if (b->second.last < a.first) {
      order.insert(false);
    } else {
      history.interleaved = true;
    }
  }
  if (history.interleaved || order.size() > 1) {
    history.interleaved = true;
    return history;
  }
  if (!order.empty()) history.second_is_later = *order.begin();
  if (!shared) {
    // Captures on one clock follow each other; where they overlap, clocks don't tell.
    Period a;
    Period b;
    for (const TableFrameSet& set : table.frame_sets) {
      if (first_periods.contains(set.capture)) a.add(set.stamp);
      if (second_periods.contains(set.capture)) b.add(set.stamp);
    }
    if (a.last < b.first) history.second_is_later = true;
    if (b.last < a.first) history.second_is_later = false;
  }

  // Looks at a place in the time of the other one.
  const double least_side_px = smallest_side_px(first, second);
  for (std::size_t f = 0; f < table.frame_sets.size(); ++f) {
    const TableFrameSet& set = table.frame_sets[f];
    const auto a = first_periods.find(set.capture);
    const auto b = second_periods.find(set.capture);
    const auto outside = [&](const Period& period, bool later) {
      return later ? set.stamp < period.first : set.stamp > period.last;
    };
    bool first_gone = false;  // the frame set belongs to the second place's time
    bool second_gone = false;
    if (a != first_periods.end() && b != second_periods.end()) {
      second_gone = outside(b->second, *history.second_is_later);
      first_gone = outside(a->second, !*history.second_is_later);
    } else if (a != first_periods.end()) {
      second_gone = true;
    } else if (b != second_periods.end()) {
      first_gone = true;
    }
    const int frame_set = static_cast<int>(f);
    if ((second_gone && looks_at(evidence, frame_set, second.place, least_side_px)) ||
        (first_gone && looks_at(evidence, frame_set, first.place, least_side_px))) {
      ++history.empty_looks;
    }
  }
  if (history.empty_looks >= kLeastEmptyLooks) {
    history.story = shared ? PlaceStory::moved_during_capture : PlaceStory::moved_between_captures;
  }
  return history;
}

}  // namespace waymark
