#include "mapbuilder/diagnosis/moving_markers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace waymark {
namespace {

/// Views that hypotheses are made of, spread over all.
constexpr std::size_t kMostSeeds = 12;

Rigid3 world_from_rig(const MarkerView& view) {
  return view.world_from_cam * view.camera->rig_from_cam.inverse();
}

bool shows(const MarkerView& view, const Rigid3& world_from_marker,
           const MovementOptions& options) {
  return distance_px(view, {world_from_marker, view.observation->size_m}) <=
         options.agrees * side_px(view);
}

/// Views that agree on one place, of the world or of the rig.
enum class FixedTo { world, rig };
std::vector<MarkerView> most_agreeing(const std::vector<MarkerView>& views, FixedTo fixed_to,
                                      const MovementOptions& options) {
  const auto frame = [&](const MarkerView& view) {
    return fixed_to == FixedTo::rig ? world_from_rig(view) : Rigid3{};
  };
  std::vector<MarkerView> best;
  const std::size_t seeds = std::min(views.size(), kMostSeeds);
  for (std::size_t s = 0; s < seeds; ++s) {
    const MarkerView& seed = views[s * views.size() / seeds];
    if (!seed.observation->ippe) continue;
    for (const Rigid3& cam_from_marker : seed.observation->ippe->cam_from_marker) {
      const Rigid3 place = frame(seed).inverse() * seed.world_from_cam * cam_from_marker;
      std::vector<MarkerView> agreeing;
      for (const MarkerView& view : views) {
        if (shows(view, frame(view) * place, options)) agreeing.push_back(view);
      }
      if (agreeing.size() > best.size()) best = std::move(agreeing);
    }
  }
  return best;
}

struct Extent {
  double way_m = 0;
  double turn_rad = 0;
};

Extent extent_of_rig(const std::vector<MarkerView>& views) {
  Extent extent;
  const Rigid3 first = world_from_rig(views.front());
  for (const MarkerView& view : views) {
    const Rigid3 rig = world_from_rig(view);
    extent.way_m = std::max(extent.way_m, (rig.translation - first.translation).norm());
    extent.turn_rad = std::max(extent.turn_rad, angle_between_rad(rig.rotation, first.rotation));
  }
  return extent;
}

/// One image of those that show views off their places.
using ImageKey = std::pair<FrameSetIndex, const RigCamera*>;
struct ImageOrder {
  bool operator()(const ImageKey& a, const ImageKey& b) const {
    return a.first != b.first ? a.first < b.first : a.second->name < b.second->name;
  }
};
using Images = std::map<ImageKey, std::vector<MarkerView>, ImageOrder>;

/// Distance of two markers of one image in sides of the first; its depth errs with the other's.
std::optional<double> apart_in_sides(const MarkerView& a, const MarkerView& b) {
  if (!a.observation->ippe || !b.observation->ippe) return std::nullopt;
  return (a.observation->ippe->cam_from_marker[0].translation -
          b.observation->ippe->cam_from_marker[0].translation)
             .norm() /
         a.observation->size_m;
}

/// Whether markers.toml states that the two move together.
bool move_together(const Observations& observations, MarkerIndex a, MarkerIndex b) {
  const auto& groups = observations.groups;
  return !groups.empty() && !groups[a].empty() && groups[a] == groups[b];
}

/// Pairs of markers that stand alike to each other in most images that show both, or that are
/// stated to.
std::vector<std::pair<MarkerIndex, MarkerIndex>> rigid_pairs(const Observations& observations,
                                                             const Images& images) {
  std::map<std::pair<MarkerIndex, MarkerIndex>, std::vector<double>> apart;
  std::vector<std::pair<MarkerIndex, MarkerIndex>> rigid;
  for (const auto& [key, views] : images) {
    for (const MarkerView& a : views) {
      for (const MarkerView& b : views) {
        if (!(a.marker < b.marker)) continue;
        if (move_together(observations, a.marker, b.marker)) {
          rigid.emplace_back(a.marker, b.marker);
          continue;
        }
        if (const auto sides = apart_in_sides(a, b)) apart[{a.marker, b.marker}].push_back(*sides);
      }
    }
  }
  constexpr std::size_t kLeastImages = 3;
  constexpr double kSame = 0.1;
  constexpr double kMost = 0.7;
  for (auto& [pair, distances] : apart) {
    std::sort(distances.begin(), distances.end());
    const double middle = distances[distances.size() / 2];
    const auto same =
        static_cast<std::size_t>(std::count_if(distances.begin(), distances.end(), [&](double d) {
          return std::abs(d - middle) <= kSame * middle;
        }));
    if (same >= kLeastImages &&
        static_cast<double>(same) >= kMost * static_cast<double>(distances.size())) {
      rigid.push_back(pair);
    }
  }
  return rigid;
}

/// What pairs connect.
std::vector<std::set<MarkerIndex>> connected(
    const std::vector<std::pair<MarkerIndex, MarkerIndex>>& pairs) {
  std::vector<std::set<MarkerIndex>> sets;
  for (const auto& [a, b] : pairs) {
    std::set<MarkerIndex> joined{a, b};
    std::erase_if(sets, [&](const std::set<MarkerIndex>& set) {
      if (!set.contains(a) && !set.contains(b)) return false;
      joined.insert(set.begin(), set.end());
      return true;
    });
    sets.push_back(std::move(joined));
  }
  return sets;
}

}  // namespace

std::optional<RidingMarker> find_riding(const std::vector<MarkerView>& views,
                                        const MovementOptions& options) {
  if (views.size() < static_cast<std::size_t>(options.least_views)) return std::nullopt;
  RidingMarker riding;
  riding.marker = views.front().marker;
  riding.views = most_agreeing(views, FixedTo::rig, options);
  if (static_cast<double>(riding.views.size()) <
      options.least_riding * static_cast<double>(views.size())) {
    return std::nullopt;
  }
  const Extent extent = extent_of_rig(riding.views);
  riding.way_m = extent.way_m;
  if (extent.way_m < options.least_way_m && extent.turn_rad < options.least_turn_rad) {
    return std::nullopt;
  }
  if (2 * most_agreeing(views, FixedTo::world, options).size() > riding.views.size()) {
    return std::nullopt;
  }
  return riding;
}

std::optional<RestlessMarker> find_restless(const std::vector<MarkerView>& views,
                                            const MovementOptions& options) {
  if (views.size() < static_cast<std::size_t>(options.least_views)) return std::nullopt;
  const std::size_t at_one_place = most_agreeing(views, FixedTo::world, options).size();
  if (at_one_place > 2 && 4 * at_one_place > views.size()) return std::nullopt;
  return RestlessMarker{views.front().marker, views};
}

std::vector<MovingGroup> find_moving_groups(const MapEvidence& evidence,
                                            const std::vector<MarkerView>& elsewhere,
                                            const MovementOptions& options) {
  Images images;
  for (const MarkerView& view : elsewhere) {
    images[{view.frame_set, view.camera}].push_back(view);
  }
  std::vector<MovingGroup> groups;
  const Observations& observations = evidence.observations();
  for (const std::set<MarkerIndex>& markers : connected(rigid_pairs(observations, images))) {
    const bool stated = move_together(observations, *markers.begin(), *markers.rbegin());
    if (!stated && markers.size() < static_cast<std::size_t>(options.least_group)) continue;
    MovingGroup group;
    group.markers.assign(markers.begin(), markers.end());
    for (const auto& [key, views] : images) {
      const auto of_group = std::count_if(views.begin(), views.end(), [&](const MarkerView& view) {
        return markers.contains(view.marker);
      });
      if (of_group < 2) continue;
      ++group.images;
      for (const MarkerView& view : evidence.views_in(key.first)) {
        if (view.camera == key.second && markers.contains(view.marker)) group.views.push_back(view);
      }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace waymark
