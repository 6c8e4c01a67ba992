#include "mapbuilder/diagnosis/turn_evidence.h"

#include <gtest/gtest.h>

#include "core/estimate/ippe.h"
#include "core/geometry/degrees.h"
#include "core/geometry/so3.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

struct Seen {
  explicit Seen(double noise_px) {
    test::RoomOptions options;
    options.noise_px = noise_px;
    room = test::make_room(options);
    observations = test::observations_of(room);
    Progress silent(false);
    result = build_map(Selection(observations), {}, silent);
  }

  [[nodiscard]] bool contradicts(int number, double turned_deg) const {
    return TurnEvidence(observations, result.estimate)
        .contradicts({observations.markers[MarkerIndex(0)].family, number},
                     so3_exp({turned_deg / kDegreesPerRadian, 0, 0}));
  }

  [[nodiscard]] Rigid3 world_from(const Observation& o, const Rigid3& cam_from_marker) const {
    const Estimate& estimate = result.estimate;
    return estimate.world_from_rig[o.frame_set]->best.pose *
           (estimate.calibration.camera(observations, o).rig_from_cam * cam_from_marker);
  }

  test::SyntheticRoom room;
  Observations observations;
  BuildResult result;
};

TEST(TurnEvidence, TurnsOfWellSeenMarkersAreContradicted) {
  const Seen seen(0.2);
  for (const int number : {3, 7, 20}) {
    EXPECT_FALSE(seen.contradicts(number, 0)) << number;
    for (const double turned_deg : {5.0, 20.0, 180.0}) {
      EXPECT_TRUE(seen.contradicts(number, turned_deg)) << number << " by " << turned_deg;
    }
  }
}

TEST(TurnEvidence, TheFlipOfAMarkerSeenFromAfarIsNot) {
  // One view: the marker's other pose in it explains the corners nearly as well.
  Seen seen(0.5);
  const MarkerIndex marker(0);
  std::optional<Observation> kept;
  std::vector<PoseOptimum> poses;
  for (std::size_t i = 0; i < seen.observations.usable && !kept; ++i) {
    const Observation& o = seen.observations[ObservationIndex(i)];
    if (o.marker == marker && area_px2(o.corners_px) < 40 * 40) kept = o;
  }
  ASSERT_TRUE(kept);
  for (std::size_t i = 0; i < seen.observations.usable; ++i) {
    const Observation& o = seen.observations[ObservationIndex(i)];
    const bool other_view = o.marker == marker && o.frame_set != kept->frame_set;
    if (other_view) seen.result.estimate.accepted[ObservationIndex(i)] = 0;
  }
  const auto& calibration = seen.result.estimate.calibration;
  const auto solutions = solve_ippe(calibration.camera(seen.observations, *kept).model,
                                    kept->corners_px, calibration.sizes_m[marker]);
  ASSERT_TRUE(solutions);
  seen.result.estimate.world_from_marker[marker] =
      seen.world_from(*kept, solutions->cam_from_marker[0]);
  const Rigid3 flipped = seen.world_from(*kept, solutions->cam_from_marker[1]);
  const Eigen::Quaterniond turn =
      seen.result.estimate.world_from_marker[marker]->rotation.conjugate() * flipped.rotation;
  EXPECT_FALSE(TurnEvidence(seen.observations, seen.result.estimate)
                   .contradicts(seen.observations.markers[marker], turn));
}

TEST(TurnEvidence, NothingIsSaidOfWhatWasNotSeen) { EXPECT_FALSE(Seen(0.2).contradicts(999, 90)); }

}  // namespace
}  // namespace waymark
