#include "mapbuilder/diagnosis/map_causes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "tests/mapbuilder/diagnosis/measured_room.h"

namespace waymark {
namespace {

using test::MeasuredRoom;

constexpr double kSigma_m = 0.003;
constexpr double kSigma_rad = 0.005;
constexpr std::uint32_t kVariants = 24;

/// The room's map as somebody measured it by hand.
MarkerMap map_by_hand(MeasuredRoom& room) {
  MarkerMap map;
  SubMap submap;
  submap.frame = FrameKind::facility;
  for (std::size_t m = 0; m < room.room.world_from_marker.size(); ++m) {
    MapMarker marker;
    marker.id = {Family::tag36h11, static_cast<int>(m)};
    marker.size_m = marker.stated_size_m = 0.3;
    marker.verified = true;
    marker.world_from_marker = room.room.world_from_marker[m];
    marker.world_from_marker.translation = room.measured(static_cast<int>(m), kSigma_m);
    marker.covariance.diagonal() << Eigen::Vector3d::Constant(kSigma_m * kSigma_m),
        Eigen::Vector3d::Constant(kSigma_rad * kSigma_rad);
    submap.markers.push_back(marker);
  }
  map.submaps.push_back(submap);
  return map;
}

struct Expected {
  Cause cause;
  std::vector<int> numbers;  ///< of the markers named; empty: the map as a whole
  std::string words;
};

/// 95 % of the variants give exactly one finding, the expected one.
void expect_right(const std::function<Expected(MarkerMap&, MeasuredRoom&, std::uint32_t)>& spoil) {
  int right = 0;
  std::string missed;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    MarkerMap map = map_by_hand(room);
    const Expected expected = spoil(map, room, seed);
    const auto findings = map_findings(map, room.result, room.observations);
    std::vector<MarkerId> markers;
    for (const int number : expected.numbers) {
      markers.push_back({Family::tag36h11, number});
    }
    if (findings.size() == 1 && findings[0].cause == expected.cause &&
        findings[0].markers == markers &&
        findings[0].text.find(expected.words) != std::string::npos) {
      ++right;
      continue;
    }
    for (const Finding& finding : findings) missed += one_line(finding) + "\n";
    missed += "-- " + std::to_string(seed) + "\n";
  }
  EXPECT_GE(20 * right, 19 * static_cast<int>(kVariants)) << missed;
}

TEST(MapCauses, ASoundMapByHandHasNone) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    MeasuredRoom room(seed);
    const auto findings = map_findings(map_by_hand(room), room.result, room.observations);
    EXPECT_THAT(findings, testing::IsEmpty()) << one_line(findings.front());
  }
}

TEST(MapCauses, OneTypingErrorIsNamedAlone) {
  expect_right([](MarkerMap& map, MeasuredRoom& room, std::uint32_t seed) {
    MapMarker& wrong = map.submaps[0].markers[seed % 30];
    wrong.world_from_marker.translation[seed % 3] += room.uniform(0.05, 3.0);
    return Expected{Cause::map_entry, {wrong.id.number}, "off where the map has it"};
  });
}

TEST(MapCauses, OneTurnedEntryIsNamedAlone) {
  expect_right([](MarkerMap& map, MeasuredRoom&, std::uint32_t seed) {
    MapMarker& wrong = map.submaps[0].markers[seed % 30];
    const double turn = 0.5 * M_PI * (1 + seed % 3);
    wrong.world_from_marker.rotation =
        wrong.world_from_marker.rotation *
        Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
    return Expected{Cause::map_entry, {wrong.id.number}, "about"};
  });
}

TEST(MapCauses, TwoExchangedLabelsAreNamedTogether) {
  expect_right([](MarkerMap& map, MeasuredRoom&, std::uint32_t seed) {
    auto& markers = map.submaps[0].markers;
    const std::size_t a = seed % 29;
    const std::size_t b = a + 1 + seed % (29 - a);
    std::swap(markers[a].world_from_marker, markers[b].world_from_marker);
    return Expected{Cause::map_entry, {static_cast<int>(a), static_cast<int>(b)}, "are exchanged"};
  });
}

TEST(MapCauses, CornersInsteadOfCentresAreToldWithTheOffset) {
  expect_right([](MarkerMap& map, MeasuredRoom&, std::uint32_t seed) {
    const Eigen::Vector3d corner((seed % 2 == 0 ? -1 : 1) * 0.15, (seed % 4 < 2 ? -1 : 1) * 0.15,
                                 0);
    for (MapMarker& marker : map.submaps[0].markers) {
      marker.world_from_marker.translation += marker.world_from_marker.rotation * corner;
    }
    return Expected{Cause::map_misfit, {}, corner.x() < 0 ? "(-0.5" : "(+0.5"};
  });
}

TEST(MapCauses, SizesWithTheMarginAreToldWithTheShare) {
  expect_right([](MarkerMap& map, MeasuredRoom& room, std::uint32_t) {
    const double factor = room.uniform(1.05, 1.6);
    for (MapMarker& marker : map.submaps[0].markers) marker.size_m *= factor;
    return Expected{Cause::map_misfit, {}, "those of markers.toml"};
  });
}

TEST(MapCauses, AnotherUnitIsNamed) {
  expect_right([](MarkerMap& map, MeasuredRoom&, std::uint32_t seed) {
    const double per_metre = std::array{1000.0, 100.0, 39.3701, 3.28084}[seed % 4];
    for (MapMarker& marker : map.submaps[0].markers) {
      marker.world_from_marker.translation *= per_metre;
    }
    return Expected{
        Cause::map_misfit, {}, std::array{"in mm?", "in cm?", "in inches?", "in feet?"}[seed % 4]};
  });
}

TEST(MapCauses, OtherAxesAreToldWithTheTurn) {
  expect_right([](MarkerMap& map, MeasuredRoom&, std::uint32_t seed) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(seed % 3));
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(seed % 2 == 0 ? M_PI : 0.5 * M_PI, axis));
    for (MapMarker& marker : map.submaps[0].markers) {
      marker.world_from_marker.rotation = marker.world_from_marker.rotation * turn;
    }
    return Expected{Cause::map_misfit, {}, "all orientations are turned"};
  });
}

TEST(MapCauses, AMirroredMapIsTold) {
  expect_right([](MarkerMap& map, MeasuredRoom&, std::uint32_t seed) {
    for (MapMarker& marker : map.submaps[0].markers) {
      Eigen::Vector3d& x = marker.world_from_marker.translation;
      x[seed % 3] = 4 - x[seed % 3];
    }
    return Expected{Cause::map_misfit, {}, "mirrored"};
  });
}

TEST(MapCauses, AnotherHallWithTheSameIdsIsAnotherPlace) {
  expect_right([](MarkerMap& map, MeasuredRoom&, std::uint32_t seed) {
    MeasuredRoom other(seed + 100);
    map = map_by_hand(other);
    return Expected{Cause::other_place, {}, "another building"};
  });
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    const MeasuredRoom room(seed);
    const MeasuredRoom other(seed + 100);
    EXPECT_TRUE(are_of_different_places(room.result.submaps[0].map, other.result.submaps[0].map));
    MeasuredRoom again(seed);
    EXPECT_FALSE(
        are_of_different_places(room.result.submaps[0].map, map_by_hand(again).submaps[0]));
  }
}

}  // namespace
}  // namespace waymark
