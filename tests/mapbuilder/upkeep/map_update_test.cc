#include "mapbuilder/upkeep/map_update.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "core/base/median.h"
#include "core/map/map_check.h"
#include "core/map/map_file.h"
#include "mapbuilder/upkeep/joined_system.h"
#include "tests/mapbuilder/upkeep/kept_up_room.h"

namespace waymark {
namespace {

using test::BuiltRound;
using test::id;
using test::marker_in;
using test::RoomToday;
using test::updated;
using test::walk_through;

constexpr int kSets = 60;

RoomToday a_room() {
  RoomToday today;
  today.options.noise_px = 0.2;
  return today;
}

/// Moved by 0.4 m along the wall it hangs on.
Rigid3 moved_place(const RoomToday& today, int number) {
  Rigid3 place = test::make_room(today.options).world_from_marker[static_cast<std::size_t>(number)];
  place.translation += place.rotation * Eigen::Vector3d(0.3, 0.2, 0);
  return place;
}

MarkerMap first_map(const RoomToday& today) {
  return BuiltRound(walk_through(today, kSets, 0, kSets)).result.map;
}

std::vector<MarkerId> ids_of(const std::vector<ComparedMarker>& markers) {
  std::vector<MarkerId> ids;
  for (const ComparedMarker& marker : markers) ids.push_back(marker.id);
  return ids;
}

std::vector<MarkerId> ids_of(const std::vector<MissingMarker>& markers) {
  std::vector<MarkerId> ids;
  for (const MissingMarker& marker : markers) ids.push_back(marker.id);
  return ids;
}

TEST(MapUpdate, WhoIsSeenImprovesAndTheOthersStayToTheBit) {
  const RoomToday today = a_room();
  const MarkerMap old_map = first_map(today);
  RoomToday with_one_camera = today;
  with_one_camera.options.cameras = 1;
  const BuiltRound round(walk_through(with_one_camera, 50, 0, 4));
  const MapUpdate update = updated(old_map, round);
  ASSERT_TRUE(check_map(update.map));
  EXPECT_TRUE(update.moved.empty() && update.missing.empty() && update.appeared.empty());
  ASSERT_FALSE(update.improved.empty());
  ASSERT_FALSE(update.unseen.empty());
  EXPECT_EQ(update.improved.size() + update.unseen.size() + update.shifted.size(), 40U);
  for (const MarkerId& one : update.unseen) {
    const MapMarker& before = marker_in(old_map, one.number);
    const MapMarker& after = marker_in(update.map, one.number);
    EXPECT_EQ(after.world_from_marker.translation, before.world_from_marker.translation);
    EXPECT_EQ(after.covariance, before.covariance);
    EXPECT_EQ(after.observations, before.observations);
  }
  for (const MarkerId& one : update.improved) {
    const MapMarker& before = marker_in(old_map, one.number);
    const MapMarker& after = marker_in(update.map, one.number);
    EXPECT_LT(after.covariance.trace(),
              std::pow(update.parts[0].misfit_sigmas, 2) * before.covariance.trace());
    EXPECT_GT(after.observations, before.observations);
    EXPECT_LT((after.world_from_marker.translation - before.world_from_marker.translation).norm(),
              0.005);
  }
}

TEST(MapUpdate, MovedNewAndGoneOnesAreNamedExactly) {
  RoomToday today = a_room();
  today.gone = {40};
  const MarkerMap old_map = first_map(today);
  today.elsewhere[5] = moved_place(today, 5);
  today.gone = {17};
  today.elsewhere[40] = moved_place(today, 30);
  const BuiltRound round(walk_through(today, 50, 0, 50));
  const MapUpdate update = updated(old_map, round);
  EXPECT_EQ(ids_of(update.moved), std::vector{id(5)});
  EXPECT_EQ(update.appeared, std::vector{id(40)});
  EXPECT_EQ(ids_of(update.missing), std::vector{id(17)});
  EXPECT_FALSE(marker_in(update.map, 17).verified);
  EXPECT_TRUE(marker_in(old_map, 17).verified);
  EXPECT_TRUE(update.unseen.empty());
  // Against a marker beside it the moved one stands where it hangs now.
  const auto& truth = test::make_room(today.options).world_from_marker;
  const Rigid3 map_from_room = marker_in(update.map, 6).world_from_marker * truth[6].inverse();
  EXPECT_LT((marker_in(update.map, 5).world_from_marker.translation -
             map_from_room * today.elsewhere[5].translation)
                .norm(),
            0.03);
  const MapUpdate dropped = updated(old_map, round, {{}, true, {}});
  EXPECT_EQ(dropped.map.submaps[0].markers.size(), update.map.submaps[0].markers.size() - 1);
  EXPECT_EQ(find_marker(dropped.map.submaps[0], id(17)), nullptr);
}

TEST(MapUpdate, TheWorldStaysTheOldOnes) {
  const RoomToday today = a_room();
  MarkerMap old_map = first_map(today);
  // A world of its own, far from where any build begins.
  const Rigid3 elsewhere{so3_exp(Eigen::Vector3d(0.1, 0.2, 2)), {100, -40, 3}};
  const Matrix6d turn = left_motion_jacobian(elsewhere);
  for (MapMarker& marker : old_map.submaps[0].markers) {
    marker.world_from_marker = elsewhere * marker.world_from_marker;
    const Matrix6d turned = turn * marker.covariance * turn.transpose();
    marker.covariance = 0.5 * (turned + turned.transpose());
  }
  const MapUpdate update = updated(old_map, BuiltRound(walk_through(today, 50, 0, 50)));
  const auto comparison = compare_frames(update.map.submaps[0], old_map.submaps[0]);
  ASSERT_TRUE(comparison);
  const Eigen::Vector3d middle = old_map.submaps[0].markers[0].world_from_marker.translation;
  const double sigma_m =
      std::sqrt(old_map.submaps[0].markers[0].covariance.topLeftCorner<3, 3>().trace());
  EXPECT_LT((comparison->old_from_new * middle - middle).norm(), sigma_m);
}

TEST(MapUpdate, WhereSigmasDoNotHoldChanceMovesNobody) {
  const RoomToday today = a_room();
  MarkerMap old_map = first_map(today);
  // As by a poor calibration: eight times what is claimed, of one marker 12 mm.
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d before = old_map.submaps[0].markers[3].world_from_marker.translation;
  for (MapMarker& marker : old_map.submaps[0].markers) {
    const double error_m = 8 * std::sqrt(marker.covariance.topLeftCorner<3, 3>().trace() / 3);
    for (double& x : marker.world_from_marker.translation) x += error_m * normal(random);
  }
  old_map.submaps[0].markers[3].world_from_marker.translation =
      before + Eigen::Vector3d(0, 0.012, 0);
  const BuiltRound round(walk_through(today, 50, 0, 50));
  EXPECT_FALSE(compare_frames(round.result.map.submaps[0], old_map.submaps[0])->moved.empty());
  const MapUpdate update = updated(old_map, round);
  EXPECT_GT(update.parts[0].misfit_sigmas, 2.0);
  EXPECT_TRUE(update.moved.empty());
  // What was seen again is no surer than that.
  const auto median_sigma_m = [](const MarkerMap& map) {
    std::vector<double> sigmas_m;
    for (const MapMarker& marker : map.submaps[0].markers) {
      sigmas_m.push_back(std::sqrt(marker.covariance.topLeftCorner<3, 3>().trace()));
    }
    return median(sigmas_m);
  };
  EXPECT_GT(median_sigma_m(update.map), median_sigma_m(old_map));
}

TEST(MapUpdate, ASuspectCarriesNothingAndIsJudged) {
  const RoomToday today = a_room();
  const MarkerMap old_map = first_map(today);
  const BuiltRound round(walk_through(today, 50, 0, 50));
  const MapUpdate update = updated(old_map, round, {{id(7)}, false, {}});
  ASSERT_EQ(update.parts.size(), 1U);
  EXPECT_EQ(ids_of(update.parts[0].comparison.suspects_in_place), std::vector{id(7)});
}

TEST(MapUpdate, ACaptureCountsOnce) {
  const RoomToday today = a_room();
  const BuiltRound round(walk_through(today, kSets, 0, kSets));
  const auto again = update_map(round.result.map, "old.map", *round.parts, {});
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(again.error().message, testing::HasSubstr("count twice"));
}

TEST(MapUpdate, AnotherBuildingIsRefused) {
  RoomToday other = a_room();
  other.options.seed = 9;
  other.options.room_m = 12;
  const auto refused = update_map(first_map(a_room()), "old.map",
                                  *BuiltRound(walk_through(other, 50, 0, 50)).parts, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().cause, Cause::other_place);
}

/// Random days in a room: markers are moved, taken down, hung up anew, new ones come, and somebody
/// walks a part of the way.
class RandomDays {
 public:
  explicit RandomDays(std::uint32_t seed) : random_(seed) {
    today_.options.noise_px = 0.2;
    today_.options.markers = 24;
    today_.options.cameras = 2;
    today_.options.seed = seed;
    for (int number = 24; number < 30; ++number) today_.gone.insert(number);
  }

  [[nodiscard]] const RoomToday& today() const { return today_; }

  void change() {
    for (int k = draw(3); k > 0; --k) {
      const int number = draw(30);
      switch (draw(3)) {
        case 0:
          today_.gone.insert(number);
          break;
        case 1:
          today_.gone.erase(number);
          if (number >= 24) today_.elsewhere[number] = moved_place(today_, draw(24));
          break;
        default:
          if (number < 24) today_.elsewhere[number] = moved_place(today_, number);
      }
    }
    // New ones hang nowhere until they came.
    for (int number = 24; number < 30; ++number) {
      if (!today_.elsewhere.contains(number)) today_.gone.insert(number);
    }
  }

  [[nodiscard]] test::SyntheticRoom walk(int day) {
    const int sets = 30 + day;
    const int first = draw(sets - 8);
    return walk_through(today_, sets, first, first + 8 + draw(sets));
  }

 private:
  int draw(int below) { return std::uniform_int_distribution<int>(0, below - 1)(random_); }

  std::mt19937 random_;
  RoomToday today_;
};

TEST(MapUpdate, NoMarkerIsEverLostAndNoneWronglyNamed) {
  int updates = 0;
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    RandomDays days(seed);
    const BuiltRound first(walk_through(days.today(), 29, 0, 29));
    MarkerMap map = first.result.map;
    // Every other one with what is known of the markers together.
    std::vector<MarkerSystem> systems;
    if (seed % 2 == 0) systems = systems_of_build(*first.parts);
    for (int day = 1; day <= 3; ++day) {
      days.change();
      const BuiltRound round(days.walk(day));
      const bool drop = day == 3;
      const auto update = update_map(map, "old.map", *round.parts, {{}, drop, systems});
      if (!update) {
        EXPECT_EQ(update.error().cause, Cause::other_place) << update.error().message;
        continue;
      }
      ++updates;
      ASSERT_TRUE(check_map(update->map)) << seed << " " << day;
      const RoomToday& today = days.today();
      for (const ComparedMarker& one : update->moved) {
        EXPECT_TRUE(today.elsewhere.contains(one.id.number)) << seed << " " << one.id.number;
      }
      for (const MissingMarker& one : update->missing) {
        const int number = one.id.number;
        EXPECT_TRUE(today.gone.contains(number) || today.elsewhere.contains(number))
            << seed << " " << number;
      }
      std::set<MarkerId> expected;
      for (const MarkerId& one : marker_ids(map)) expected.insert(one);
      expected.insert(update->appeared.begin(), update->appeared.end());
      if (drop) {
        for (const MissingMarker& one : update->missing) expected.erase(one.id);
      }
      const std::vector<MarkerId> there = marker_ids(update->map);
      EXPECT_EQ(std::set<MarkerId>(there.begin(), there.end()), expected) << seed << " " << day;
      EXPECT_EQ(there.size(), expected.size()) << seed << " " << day;
      map = update->map;
      if (seed % 2 == 0) systems = update->systems;
    }
  }
  EXPECT_GT(updates, 150);  // of 180; the others see no three markers that stayed
}

}  // namespace
}  // namespace waymark
