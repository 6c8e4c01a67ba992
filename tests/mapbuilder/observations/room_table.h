#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "mapbuilder/bundle/map_state.h"
#include "mapbuilder/observations/observation_table.h"
#include "tests/support/synthetic_room.h"

namespace waymark::test {

inline DetectedCapture capture_of(const SyntheticRoom& room, const std::string& name = "room") {
  return {name, room.rig, room.catalog, room.images, kDefaultSyncTolerance};
}

/// The room's observations; whitened by 1 px until something else is asked for.
inline ObservationTable table_of(const SyntheticRoom& room, const TableOptions& options = {}) {
  auto table = make_observation_table({capture_of(room)}, options);
  EXPECT_TRUE(table) << table.error().message;
  return std::move(*table);
}

/// The state at truth: every marker and every frame set of the table.
inline MapState true_state(const SyntheticRoom& room, const ObservationTable& table) {
  MapState state(table);
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    state.world_from_marker[m] =
        room.world_from_marker[static_cast<std::size_t>(table.markers[m].number)];
  }
  for (std::size_t f = 0; f < table.frame_sets.size(); ++f) {
    RigPoseEstimate estimate;
    estimate.best.pose = room.world_from_rig[f];
    state.rigs[f] = estimate;
  }
  return state;
}

inline std::vector<std::size_t> all_observations(const ObservationTable& table) {
  std::vector<std::size_t> all(table.observations.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

}  // namespace waymark::test
