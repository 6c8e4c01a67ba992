#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>

#include "mapbuilder/bundle/prepared_observations.h"
#include "tests/support/synthetic_room.h"

namespace waymark::test {

inline DetectedCapture capture_of(const SyntheticRoom& room, const std::string& name = "room") {
  return {name, room.rig, room.catalog, room.images, kDefaultSyncTolerance};
}

inline Observations observations_of(const SyntheticRoom& room,
                                    const ObservationOptions& options = {}) {
  auto observations = make_observations({capture_of(room)}, options);
  EXPECT_TRUE(observations) << observations.error().message;
  return std::move(*observations);
}

/// The estimate at truth: every marker and every frame set.
inline Estimate true_estimate(const SyntheticRoom& room, const Selection& selection) {
  Estimate estimate(selection, NoiseModel{});
  const Observations& observations = selection.observations();
  for (const MarkerIndex m : observations.markers.indices()) {
    estimate.world_from_marker[m] =
        room.world_from_marker[static_cast<std::size_t>(observations.markers[m].number)];
  }
  for (const FrameSetIndex f : observations.frame_sets.indices()) {
    estimate.world_from_rig[f] = RigPoseEstimate{};
    estimate.world_from_rig[f]->best.pose = room.world_from_rig[f.value()];
  }
  return estimate;
}

/// A room's observations, all selected, with the estimate at truth that they are prepared by;
/// whitened by 1 px unless the detections state a covariance.
struct PreparedRoom {
  using Edit = std::function<void(Observations&)>;

  /// `edit` changes observations before anything is made of them.
  explicit PreparedRoom(const SyntheticRoom& room, const Edit& edit = {})
      : observations(edited(observations_of(room), edit)),
        selection(observations),
        truth(true_estimate(room, selection)),
        prepared(selection, truth, 1) {}
  PreparedRoom(const PreparedRoom&) = delete;
  PreparedRoom& operator=(const PreparedRoom&) = delete;

  [[nodiscard]] std::vector<ObservationIndex> all() const {
    return {selection.used().begin(), selection.used().end()};
  }

  Observations observations;
  Selection selection;
  Estimate truth;
  PreparedObservations prepared;

 private:
  static Observations edited(Observations observations, const Edit& edit) {
    if (edit) edit(observations);
    return observations;
  }
};

}  // namespace waymark::test
