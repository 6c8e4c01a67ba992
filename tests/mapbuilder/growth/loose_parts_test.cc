#include "mapbuilder/growth/loose_parts.h"

#include <set>

#include "mapbuilder/bundle/outlier_gate.h"
#include "tests/mapbuilder/observations/room_table.h"

namespace waymark {
namespace {

/// The rig turns twice on its way around the room; half the way shows every wall once.
constexpr int kFrameSets = 60;
constexpr int kMiddle = kFrameSets / 2;

/// A room walked with one camera in which a marker of the first half hangs a second time in the
/// second half, and the map that growth makes of it when it takes both for one: the second half
/// stands where both copies lie on each other.
class LooseParts : public testing::Test {
 protected:
  LooseParts() {
    test::RoomOptions options;
    options.cameras = 1;
    options.frame_sets = 2 * kFrameSets;
    options.noise_px = 0.1;
    options.state_covariances = true;
    room_ = test::make_room(options);
    room_.images.resize(kFrameSets);
    room_.world_from_rig.resize(kFrameSets);
    const auto clean = test::table_of(room_);
    std::vector<int> early(clean.markers.size(), 0);
    std::vector<int> late(clean.markers.size(), 0);
    for (const TableObservation& o : clean.observations) {
      ++(o.frame_set < kMiddle ? early : late)[static_cast<std::size_t>(o.marker)];
    }
    const auto most = [](const std::vector<int>& of, const std::vector<int>& none_of) {
      std::size_t best = 0;
      for (std::size_t m = 0; m < of.size(); ++m) {
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
    table_ = test::table_of(room_);
    for (std::size_t m = 0; m < table_.markers.size(); ++m) {
      if (table_.markers[m].number == twin) twin_ = static_cast<int>(m);
      if (late[m] > early[m]) displaced_.insert(static_cast<int>(m));
    }
    wrong_from_true_ = room_.world_from_marker[static_cast<std::size_t>(twin)] * second.inverse();
  }

  /// A rig of one camera is that camera.
  MapState true_state() {
    MapState state = test::true_state(room_, table_);
    for (auto& rig : state.rigs) {
      rig->best.pose = rig->best.pose * room_.rig.cameras.front().rig_from_cam;
    }
    return state;
  }

  /// The state with the second half displaced, gated.
  MapState displaced_state() {
    MapState state = true_state();
    for (const int m : displaced_) {
      auto& pose = state.world_from_marker[static_cast<std::size_t>(m)];
      pose = wrong_from_true_ * *pose;
    }
    for (std::size_t f = kMiddle; f < state.rigs.size(); ++f) {
      state.rigs[f]->best.pose = wrong_from_true_ * state.rigs[f]->best.pose;
    }
    update_gate(table_, test::all_observations(table_), {}, state);
    return state;
  }

  test::SyntheticRoom room_;
  ObservationTable table_;
  int twin_ = -1;
  std::set<int> displaced_;
  Rigid3 wrong_from_true_;
};

TEST_F(LooseParts, HangWhereMostMarkersAgree) {
  const auto parts = find_loose_parts(table_, test::all_observations(table_), 0, displaced_state());
  ASSERT_FALSE(parts.empty());
  EXPECT_EQ(parts.front().hinge, twin_);
  EXPECT_GE(parts.front().markers, 2U);
  const Rigid3 left = parts.front().new_from_old * wrong_from_true_;
  EXPECT_LT(left.translation.norm(), 0.1);
  EXPECT_LT(angle_between_rad(left.rotation, Eigen::Quaterniond::Identity()), 0.03);
}

TEST_F(LooseParts, AreRehungAndTheTwinAloneContradicts) {
  MapState state = displaced_state();
  BuildOptions options;
  options.threads = 1;
  Progress silent;
  const auto components =
      connected_components(table_, std::vector<char>(table_.observations.size(), 1));
  ASSERT_EQ(components.size(), 1U);
  ComponentGrowth growth(table_, components.front(), options);
  JointBuild build(table_, {&growth}, options, silent, state);
  build.settle();
  rehang_loose_parts(build);
  std::set<int> contradicting;
  for (std::size_t i = 0; i < table_.observations.size(); ++i) {
    if (state.accepted[i] == 0) contradicting.insert(table_.observations[i].marker);
  }
  EXPECT_EQ(contradicting, std::set<int>{twin_});
}

TEST_F(LooseParts, OneMarkersWordIsNotEnough) {
  const MapState state = displaced_state();
  std::vector<std::size_t> kept;
  int witness = -1;
  for (const std::size_t i : test::all_observations(table_)) {
    if (state.accepted[i] == 0) {
      if (witness < 0) witness = table_.observations[i].marker;
      if (table_.observations[i].marker != witness) continue;
    }
    kept.push_back(i);
  }
  ASSERT_GE(witness, 0);
  EXPECT_TRUE(find_loose_parts(table_, kept, 0, state).empty());
}

TEST_F(LooseParts, AMapWithoutContradictionHasNone) {
  MapState state = true_state();
  update_gate(table_, test::all_observations(table_), {}, state);
  EXPECT_TRUE(find_loose_parts(table_, test::all_observations(table_), 0, state).empty());
}

}  // namespace
}  // namespace waymark
