#include <algorithm>
#include <cmath>

#include "bench/cause_variants/faults.h"
#include "core/geometry/so3.h"

namespace waymark::bench {
namespace {

using simulator::Random;

/// No marker is seen in both halves of the way.
bool two_parts(Variant& variant, Random&) {
  const World& world = variant.world();
  const Stamp half = world.stamps[world.sets / 2].front();
  std::map<MarkerId, std::pair<int, int>> seen;
  const auto images = seen_images(world);
  for (const ImageDetections& image : images) {
    for (const Detection& d : image.detections) {
      ++(image.stamp < half ? seen[d.marker].first : seen[d.marker].second);
    }
  }
  std::set<MarkerId> first;
  std::set<MarkerId> second;
  for (const auto& [marker, counts] : seen) {
    (counts.first > counts.second ? first : second).insert(marker);
  }
  if (first.size() < 4 || second.size() < 4) return false;
  variant.on_images.emplace_back([half, first](std::vector<ImageDetections>& all) {
    for (ImageDetections& image : all) {
      std::erase_if(image.detections, [&](const Detection& d) {
        return first.contains(d.marker) != (image.stamp < half);
      });
    }
  });
  variant.truth.causes = {Cause::disconnected};
  variant.truth.at_least = Severity::note;
  variant.truth.exits = {0};
  return true;
}

/// Two halls whose markers carry the same ids.
bool two_halls(Variant& variant, Random& random) {
  variant.worlds.push_back(variant.world());
  World& other = variant.worlds.back();
  other.seed = random.bits();
  auto& markers = other.scene.markers;
  for (std::size_t i = 0; i + 1 < markers.size(); ++i) {
    auto& with = markers[i + random.below(markers.size() - i)];
    std::swap(markers[i].id, with.id);
  }
  for (auto& marker : markers) marker.size_m = *other.stated_catalog.size_m(marker.id);
  const Stamp later = std::chrono::hours(1);
  for (auto& set : other.stamps) {
    for (Stamp& stamp : set) stamp += later;
  }
  variant.truth.causes = {Cause::other_place};
  variant.truth.exits = {65};
  return true;
}

/// Asked to level by walls where all markers hang on one.
bool one_wall(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto often = often_seen(world, 6, 1, random);
  if (often.empty()) return false;
  const int surface = world.scene.markers[often.front()].surface;
  std::erase_if(world.scene.markers, [&](const auto& marker) { return marker.surface != surface; });
  if (often_seen(world, 4, 5, random).size() < 5) return false;
  variant.level = LevelBy::floor;
  variant.truth.causes = {Cause::not_level};
  variant.truth.exits = {0};
  return true;
}

/// Said of every map by sizes alone.
bool no_length(Variant& variant, Random&) {
  variant.truth.causes = {Cause::scale_unknown};
  variant.truth.at_least = Severity::note;
  variant.truth.exits = {0};
  return true;
}

/// Entries of a map by hand that the capture can judge.
std::vector<std::size_t> judged_entries(const World& world, std::size_t count, Random& random) {
  if (often_seen(world, 6, 8, random).size() < 8) return {};
  return often_seen(world, 8, count, random);
}

bool wrong_entry(Variant& variant, Random& random) {
  const World& world = variant.world();
  const auto which = judged_entries(world, 1, random);
  if (which.empty()) return false;
  HandMap map = measured_map(world, random);
  auto& entry = map.entries[which.front()];
  entry.world_from_marker.translation[static_cast<Eigen::Index>(random.below(3))] +=
      either_sign(0.1, 1.0, random);
  variant.hand_map_json = hall_json(map);
  variant.truth.causes = {Cause::map_entry};
  variant.truth.markers = {entry.id};
  variant.truth.exits = {0};
  return true;
}

bool entries_exchanged(Variant& variant, Random& random) {
  const World& world = variant.world();
  const auto which = judged_entries(world, 2, random);
  if (which.size() < 2) return false;
  HandMap map = measured_map(world, random);
  auto& a = map.entries[which[0]];
  auto& b = map.entries[which[1]];
  if (a.size_m != b.size_m) return false;
  std::swap(a.world_from_marker, b.world_from_marker);
  variant.hand_map_json = hall_json(map);
  variant.truth.causes = {Cause::map_entry};
  variant.truth.markers = {a.id, b.id};
  variant.truth.exits = {0};
  return true;
}

/// Another unit, other axes, another spot of every marker, sizes with their margin.
bool all_entries(Variant& variant, Random& random) {
  const World& world = variant.world();
  if (judged_entries(world, 1, random).empty()) return false;
  HandMap map = measured_map(world, random);
  const auto kind = random.below(4);
  constexpr double kPerMetre[] = {1000, 100, 1 / 0.0254};
  const double per_metre = kPerMetre[random.below(3)];
  for (auto& entry : map.entries) {
    Rigid3& x = entry.world_from_marker;
    if (kind == 0) x.translation *= per_metre;
    if (kind == 1) x.translation.y() = -x.translation.y();
    if (kind == 2) x.translation += x.rotation * (0.5 * entry.size_m * Eigen::Vector3d(-1, -1, 0));
    if (kind == 3) x.rotation = x.rotation * so3_exp({0, 1.5707963, 0});
  }
  variant.hand_map_json = hall_json(map);
  variant.truth.causes = {Cause::map_misfit};
  variant.truth.exits = {65};
  return true;
}

bool sizes_with_margin(Variant& variant, Random& random) {
  const World& world = variant.world();
  if (judged_entries(world, 1, random).empty()) return false;
  HandMap map = measured_map(world, random);
  const double factor = random.uniform(1.1, 1.35);
  for (auto& entry : map.entries) entry.size_m *= factor;
  variant.hand_map_json = hall_json(map);
  variant.truth.causes = {Cause::map_misfit};
  variant.truth.value = 100 * (factor - 1);
  variant.truth.within = 0.5;
  variant.truth.exits = {65};
  return true;
}

constexpr Fault kFaults[] = {
    {Cause::disconnected, "two parts share no marker", 1, false, two_parts},
    {Cause::other_place, "two halls with the same ids", 1, false, two_halls},
    {Cause::not_level, "level by a floor where one wall is seen", 1, false, one_wall},
    {Cause::scale_unknown, "no measured length", 1, false, no_length},
    {Cause::map_entry, "one entry of a map by hand wrong", 1, false, wrong_entry},
    {Cause::map_entry, "two entries exchanged", 1, false, entries_exchanged},
    {Cause::map_misfit, "unit, axes or spot of all entries", 1, false, all_entries},
    {Cause::map_misfit, "sizes of the map with margin", 1, false, sizes_with_margin},
};

}  // namespace

std::span<const Fault> map_faults() { return kFaults; }

}  // namespace waymark::bench
