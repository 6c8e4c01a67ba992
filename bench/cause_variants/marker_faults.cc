#include <algorithm>
#include <cmath>

#include "bench/cause_variants/faults.h"
#include "core/geometry/so3.h"

namespace waymark::bench {
namespace {

using simulator::Random;

constexpr int kOften = 10;

/// A number of the family that hangs nowhere.
MarkerId unused_id(const World& world, int after) {
  std::set<int> used;
  for (const auto& marker : world.scene.markers) used.insert(marker.id.number);
  MarkerId id = world.scene.markers.front().id;
  id.number = after;
  while (used.contains(id.number)) ++id.number;
  return id;
}

bool wrong_ids(Variant& variant, Random& random) {
  const World& world = variant.world();
  std::vector<ImageDetections> images = seen_images(world);
  const auto often = often_seen(world, 5, world.scene.markers.size(), random);
  if (often.size() < 6) return false;
  // Each beside others, so that it contradicts them.
  std::vector<std::pair<std::size_t, std::size_t>> where;
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (std::size_t d = 0; d < images[i].detections.size(); ++d) {
      if (images[i].detections.size() >= 3) where.emplace_back(i, d);
    }
  }
  if (where.size() < 20) return false;
  std::vector<std::tuple<std::size_t, std::size_t, MarkerId>> misread;
  const std::size_t count = 1 + where.size() / 100;
  for (std::size_t n = 0; n < count; ++n) {
    const auto [i, d] = where[random.below(where.size())];
    const MarkerId read = world.scene.markers[often[random.below(often.size())]].id;
    const auto& detections = images[i].detections;
    if (std::any_of(detections.begin(), detections.end(),
                    [&](const Detection& other) { return other.marker == read; })) {
      continue;
    }
    variant.truth.markers.insert(read);
    variant.truth.markers.insert(detections[d].marker);
    misread.emplace_back(i, d, read);
    variant.truth.cameras.insert(
        world.rig.cameras[static_cast<std::size_t>(images[i].camera)].name);
  }
  if (misread.empty()) return false;
  variant.on_images.emplace_back([misread](std::vector<ImageDetections>& seen) {
    for (const auto& [i, d, read] : misread) seen[i].detections[d].marker = read;
  });
  variant.truth.causes = {Cause::wrong_id};
  variant.truth.exits = {0};
  return true;
}

/// A second print of one marker hangs in another's place.
bool twin(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto markers = often_seen(world, kOften, 2, random);
  if (markers.size() < 2) return false;
  auto& first = world.scene.markers[markers[0]];
  auto& second = world.scene.markers[markers[1]];
  if ((first.world_from_marker.translation - second.world_from_marker.translation).norm() < 1) {
    return false;
  }
  second.id = first.id;
  second.size_m = first.size_m;
  variant.truth.causes = {Cause::twin};
  variant.truth.markers = {first.id};
  variant.truth.exits = {0};
  return true;
}

bool moved(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto images = seen_images(world);
  const auto markers = often_seen(world, kOften, 12, random);
  const std::size_t half = world.sets / 2;
  for (const std::size_t marker : markers) {
    int before = 0;
    int after = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
      for (const Detection& d : images[i].detections) {
        if (d.marker != world.scene.markers[marker].id) continue;
        ++(i / world.cameras() < half ? before : after);
      }
    }
    if (std::min(before, after) < 4) continue;
    const Rigid3 place = world.scene.markers[marker].world_from_marker;
    const double way_m = random.uniform(0.1, 0.5);
    const double angle = random.uniform(0, 6.28);
    const Rigid3 there =
        place * Rigid3{Eigen::Quaterniond::Identity(),
                       way_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)};
    auto& places = world.wandering[marker];
    for (std::size_t set = 0; set < world.sets; ++set) places.push_back(set < half ? place : there);
    variant.truth.causes = {Cause::moved};
    variant.truth.markers = {world.scene.markers[marker].id};
    variant.truth.value = way_m;
    variant.truth.within = 0.01;
    variant.truth.exits = {0};
    return true;
  }
  return false;
}

/// Hangs on something that never rests.
bool restless(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto markers = often_seen(world, kOften, 1, random);
  if (markers.empty()) return false;
  const Rigid3 place = world.scene.markers[markers[0]].world_from_marker;
  auto& places = world.wandering[markers[0]];
  for (std::size_t set = 0; set < world.sets; ++set) {
    places.push_back(place * Rigid3{so3_exp({0, 0, 0.2 * random.normal()}),
                                    {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0}});
  }
  variant.truth.causes = {Cause::moved};
  variant.truth.markers = {world.scene.markers[markers[0]].id};
  variant.truth.exits = {0};
  return true;
}

/// Sits on the vehicle before one camera.
bool riding(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = random.below(world.cameras());
  simulator::PlacedMarker rider = world.scene.markers.front();
  rider.id = unused_id(world, 700);
  rider.size_m = 0.1;
  // Faces the camera from below the middle of its image.
  const Eigen::Quaterniond facing = so3_exp({3.14159265, 0, 0});
  const Rigid3 rig_from_rider =
      world.rig.cameras[camera].rig_from_cam *
      Rigid3{facing * so3_exp({random.uniform(0.2, 0.5), random.uniform(-0.3, 0.3), 0}),
             {random.uniform(-0.08, 0.08), random.uniform(0.05, 0.12), random.uniform(0.5, 0.8)}};
  const std::size_t index = world.scene.markers.size();
  rider.world_from_marker = world.world_from_rig_at_set(0) * rig_from_rider;
  world.scene.markers.push_back(rider);
  for (std::size_t set = 0; set < world.sets; ++set) {
    world.wandering[index].push_back(world.world_from_rig_at_set(set) * rig_from_rider);
  }
  auto entries = world.stated_catalog.entries();
  entries.front().size_m_by_id[rider.id.number] = rider.size_m;
  world.stated_catalog = MarkerCatalog(std::move(entries));
  if (sights_of(world, seen_images(world)).back() < kOften) return false;
  variant.truth.causes = {Cause::riding};
  variant.truth.markers = {rider.id};
  variant.truth.cameras = every_camera(world);
  variant.truth.exits = {0};
  return true;
}

/// A board of 3 × 2 markers that somebody carries about before the cameras; its ids hang on the
/// walls, too.
bool board(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto walls = often_seen(world, 6, 6, random);
  if (walls.size() < 6) return false;
  const double size_m = 0.088;
  std::vector<std::size_t> prints;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    simulator::PlacedMarker print = world.scene.markers[walls[i]];
    print.size_m = size_m;
    prints.push_back(world.scene.markers.size());
    world.scene.markers.push_back(print);
    variant.truth.markers.insert(print.id);
  }
  const std::size_t camera = random.below(world.cameras());
  const Eigen::Quaterniond facing = so3_exp({3.14159265, 0, 0});
  for (std::size_t set = 0; set < world.sets; ++set) {
    // Held up in the first third of the way.
    const bool shown = 3 * set < world.sets;
    const Rigid3 rig_from_board =
        world.rig.cameras[camera].rig_from_cam *
        Rigid3{facing * so3_exp({random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4),
                                 random.uniform(-0.3, 0.3)}),
               {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1),
                shown ? random.uniform(0.8, 1.4) : -50}};
    for (std::size_t i = 0; i < prints.size(); ++i) {
      const Rigid3 board_from_print{
          Eigen::Quaterniond::Identity(),
          {0.11 * (static_cast<double>(i % 3) - 1), 0.11 * (static_cast<double>(i / 3) - 0.5), 0}};
      world.wandering[prints[i]].push_back(world.world_from_rig_at_set(set) * rig_from_board *
                                           board_from_print);
    }
  }
  variant.truth.causes = {Cause::moving_group};
  variant.truth.exits = {0};
  return true;
}

/// A marker is seen in one image only.
bool seen_once(Variant& variant, Random& random) {
  const World& world = variant.world();
  const auto markers = often_seen(world, kOften, 1, random);
  if (markers.empty()) return false;
  const MarkerId id = world.scene.markers[markers[0]].id;
  variant.on_images.emplace_back([id](std::vector<ImageDetections>& images) {
    bool seen = false;
    for (ImageDetections& image : images) {
      std::erase_if(image.detections, [&](const Detection& d) {
        const bool again = d.marker == id && seen;
        seen = seen || d.marker == id;
        return again;
      });
    }
  });
  variant.truth.causes = {Cause::few_views};
  variant.truth.markers = {id};
  variant.truth.at_least = Severity::note;
  variant.truth.exits = {0};
  return true;
}

constexpr Fault kFaults[] = {
    {Cause::wrong_id, "one in a hundred misread", 1, false, wrong_ids},
    {Cause::twin, "an id hangs twice", 1, false, twin},
    {Cause::moved, "a marker moved half-way", 1, false, moved},
    {Cause::moved, "a marker never rests", 1, false, restless},
    {Cause::moving_group, "a board with ids of the walls", 1, false, board},
    {Cause::riding, "a marker on the vehicle", 1, false, riding},
    {Cause::few_views, "a marker seen once", 1, false, seen_once},
};

}  // namespace

std::span<const Fault> marker_faults() { return kFaults; }

}  // namespace waymark::bench
