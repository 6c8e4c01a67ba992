#include "mapbuilder/growth/misplaced_subgraphs.h"

#include <optional>
#include <set>

#include "mapbuilder/bundle/outlier_gate.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

/// The rig turns twice on its way around the room; half the way shows every wall once.
constexpr int kFrameSets = 60;
constexpr int kMiddle = kFrameSets / 2;

/// A room walked with one camera in which a marker of the first half hangs a second time in the
/// second half, and the map that growth makes of it when it takes both for one: the second half
/// stands where both copies lie on each other.
class MisplacedSubgraphs : public testing::Test {
 protected:
  MisplacedSubgraphs() {
    test::RoomOptions options;
    options.cameras = 1;
    options.frame_sets = 2 * kFrameSets;
    options.noise_px = 0.1;
    options.state_covariances = true;
    room_ = test::make_room(options);
    room_.images.resize(kFrameSets);
    room_.world_from_rig.resize(kFrameSets);
    const auto clean = test::observations_of(room_);
    using Counts = IndexedVector<MarkerIndex, int>;
    Counts early(clean.markers.size(), 0);
    Counts late(clean.markers.size(), 0);
    for (const Observation& o : clean.all) {
      ++(o.frame_set < FrameSetIndex(kMiddle) ? early : late)[o.marker];
    }
    const auto most = [](const Counts& of, const Counts& none_of) {
      MarkerIndex best;
      for (const MarkerIndex m : of.indices()) {
        if (none_of[m] == 0 && (none_of[best] != 0 || of[m] > of[best])) best = m;
      }
      return best;
    };
    const int twin = clean.markers[most(early, late)].number;
    const auto beside = static_cast<std::size_t>(clean.markers[most(late, early)].number);
    const Rigid3 second =
        room_.world_from_marker[beside] * Rigid3{Eigen::Quaterniond::Identity(), {0.0, 0.5, 0.0}};
    test::hang(room_, twin, second, options.marker_m,
               [](Stamp stamp) { return stamp >= test::room_stamp(kMiddle); });
    known_.emplace(room_);
    for (const MarkerIndex m : known_->observations.markers.indices()) {
      if (known_->observations.markers[m].number == twin) twin_ = m;
      if (late[m] > early[m]) displaced_.insert(m);
    }
    wrong_from_true_ = room_.world_from_marker[static_cast<std::size_t>(twin)] * second.inverse();
  }

  /// A rig of one camera is that camera.
  [[nodiscard]] Estimate true_estimate() const {
    Estimate estimate = known_->truth;
    for (auto& rig : estimate.world_from_rig) {
      rig->best.pose = rig->best.pose * room_.rig.cameras.front().rig_from_cam;
    }
    return estimate;
  }

  [[nodiscard]] Estimate gated(Estimate estimate) const {
    return gate_outliers(known_->prepared, known_->all(), {}, std::move(estimate)).estimate;
  }

  /// The second half displaced, gated.
  [[nodiscard]] Estimate displaced_estimate() const {
    Estimate estimate = true_estimate();
    for (const MarkerIndex m : displaced_) {
      estimate.world_from_marker[m] = wrong_from_true_ * *estimate.world_from_marker[m];
    }
    for (const FrameSetIndex f : estimate.world_from_rig.indices()) {
      if (f < FrameSetIndex(kMiddle)) continue;
      Rigid3& pose = estimate.world_from_rig[f]->best.pose;
      pose = wrong_from_true_ * pose;
    }
    return gated(std::move(estimate));
  }

  test::SyntheticRoom room_;
  std::optional<test::PreparedRoom> known_;
  MarkerIndex twin_;
  std::set<MarkerIndex> displaced_;
  Rigid3 wrong_from_true_;
};

TEST_F(MisplacedSubgraphs, HangWhereMostMarkersAgree) {
  const auto found = find_misplaced_subgraphs(known_->prepared, known_->all(), FrameSetIndex(0),
                                              displaced_estimate());
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().hinge, twin_);
  EXPECT_GE(found.front().markers, 2U);
  const Rigid3 left = found.front().new_from_old * wrong_from_true_;
  EXPECT_LT(left.translation.norm(), 0.1);
  EXPECT_LT(angle_between_rad(left.rotation, Eigen::Quaterniond::Identity()), 0.03);
}

TEST_F(MisplacedSubgraphs, AreMovedAndTheTwinAloneContradicts) {
  MapperOptions options;
  options.threads = 1;
  Progress silent;
  const IncrementalMapper mapper(known_->selection, options);
  ASSERT_EQ(known_->selection.components().size(), 1U);
  const ComponentIndex all(0);
  Estimate estimate = mapper.converge({{all}, {}}, displaced_estimate(), silent).estimate;
  estimate = move_misplaced_subgraphs(mapper, all, std::move(estimate), silent);
  std::set<MarkerIndex> contradicting;
  for (const ObservationIndex index : known_->selection.used()) {
    if (!estimate.accepts(index)) contradicting.insert(known_->observations[index].marker);
  }
  EXPECT_EQ(contradicting, std::set<MarkerIndex>{twin_});
}

TEST_F(MisplacedSubgraphs, OneMarkersWordIsNotEnough) {
  const Estimate estimate = displaced_estimate();
  std::vector<ObservationIndex> left;
  std::optional<MarkerIndex> witness;
  for (const ObservationIndex index : known_->selection.used()) {
    const MarkerIndex marker = known_->observations[index].marker;
    if (!estimate.accepts(index)) {
      if (!witness) witness = marker;
      if (marker != *witness) continue;
    }
    left.push_back(index);
  }
  ASSERT_TRUE(witness);
  EXPECT_TRUE(find_misplaced_subgraphs(known_->prepared, left, FrameSetIndex(0), estimate).empty());
}

TEST_F(MisplacedSubgraphs, AMapWithoutContradictionHasNone) {
  EXPECT_TRUE(find_misplaced_subgraphs(known_->prepared, known_->all(), FrameSetIndex(0),
                                       gated(true_estimate()))
                  .empty());
}

}  // namespace
}  // namespace waymark
