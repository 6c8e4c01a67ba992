#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "core/map/marker_search.h"
#include "mapbuilder/upkeep/map_update.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark::test {

/// A room as it is today: which of its markers hang there, and where those that were moved hang.
struct RoomToday {
  RoomOptions options;
  std::set<int> gone;
  std::map<int, Rigid3> elsewhere;  ///< moved ones, and new ones by numbers of their own
};

/// Some frame sets of a walk through it; another number of sets is another walk, with other noise.
inline SyntheticRoom walk_through(const RoomToday& today, int frame_sets, int first, int last) {
  RoomOptions options = today.options;
  options.frame_sets = frame_sets;
  options.noise_px = 0;  // that of walks with as many sets in common would be the same
  SyntheticRoom room = make_room(options);
  std::erase_if(room.images, [&](const ImageDetections& image) {
    return image.stamp < room_stamp(first) || image.stamp > room_stamp(last);
  });
  for (ImageDetections& image : room.images) {
    std::erase_if(image.detections, [&](const Detection& d) {
      return today.gone.contains(d.marker.number) || today.elsewhere.contains(d.marker.number);
    });
  }
  for (const auto& [number, place] : today.elsewhere) {
    if (today.gone.contains(number)) continue;
    hang(room, number, place, options.marker_m, [](Stamp) { return true; });
  }
  std::mt19937 random(1000 * options.seed + static_cast<std::uint32_t>(frame_sets));
  std::normal_distribution<double> noise;
  for (ImageDetections& image : room.images) {
    for (Detection& d : image.detections) {
      for (Eigen::Vector2d& corner : d.corners) {
        corner.x() += today.options.noise_px * noise(random);
        corner.y() += today.options.noise_px * noise(random);
      }
    }
  }
  return room;
}

/// What a round sees, and the map that it gives by itself.
struct BuiltRound {
  explicit BuiltRound(const SyntheticRoom& room) : observations(observations_of(room)) {
    Progress progress(false);
    BuildOptions options;
    options.threads = 1;
    result = build_map(Selection(observations), options, progress);
    parts = std::make_unique<RoundParts>(observations, result, options);
  }
  BuiltRound(const BuiltRound&) = delete;
  BuiltRound& operator=(const BuiltRound&) = delete;

  Observations observations;
  BuildResult result;
  std::unique_ptr<RoundParts> parts;
};

inline MarkerId id(int number) { return {Family::tag36h11, number}; }

inline const MapMarker& marker_in(const MarkerMap& map, int number) {
  for (const SubMap& submap : map.submaps) {
    if (const MapMarker* marker = find_marker(submap, id(number))) return *marker;
  }
  ADD_FAILURE() << "no marker " << number;
  return map.submaps.front().markers.front();
}

inline MapUpdate updated(const MarkerMap& map, const BuiltRound& round,
                         const UpdateOptions& options = {}) {
  auto update = update_map(map, "old.map", *round.parts, options);
  EXPECT_TRUE(update) << update.error().message;
  return update ? *std::move(update) : MapUpdate{};
}

}  // namespace waymark::test
