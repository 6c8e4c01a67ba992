#include "mapbuilder/upkeep/difference_format.h"

#include <gmock/gmock.h>

#include "core/map/map_edit.h"
#include "tests/support/hall_map.h"
#include "tests/support/small_map.h"

namespace waymark {
namespace {

using testing::HasSubstr;

MarkerId id(int number) { return {Family::tag36h11, number}; }

/// small_map() half a metre further, marker 586 raised, 12 renamed, 7 gone, 5 new, 3 of another
/// size, z up.
MarkerMap changed_map() {
  MarkerMap map = test::small_map();
  SubMap& first = map.submaps[0];
  first.markers[1].id = id(13);
  MapMarker fresh = first.markers[0];
  fresh.id = id(5);
  fresh.world_from_marker.translation = {0, 3, 0};
  first.markers.insert(first.markers.begin() + 1, fresh);
  // Markers that stay, so that the rest can be told against them.
  first.markers[0].size_m = 0.125;
  first.z_is_up = true;
  for (MapMarker& marker : first.markers) marker.world_from_marker.translation.x() += 0.5;
  map.submaps[1].markers.pop_back();
  sort_map(map);
  return map;
}

MapDifference difference(const MarkerMap& old_map, const MarkerMap& new_map) {
  const auto made = difference_of(old_map, "old.map", new_map, "new.map");
  EXPECT_TRUE(made) << made.error().message;
  return *made;
}

/// The same with three markers that stay.
MarkerMap with_more(MarkerMap map, double shift_m) {
  for (const int number : {20, 21, 22}) {
    MapMarker marker = map.submaps[0].markers[0];
    marker.id = id(number);
    marker.size_m = 0.12;
    marker.world_from_marker.translation = {shift_m + number - 20.0, 1.0 * (number % 2), 2};
    map.submaps[0].markers.push_back(marker);
  }
  sort_map(map);
  return map;
}

MapDifference golden() {
  MarkerMap now = with_more(changed_map(), 0.5);
  now.submaps[0].markers.back().world_from_marker.translation.z() += 0.25;  // 586
  return difference(with_more(test::small_map(), 0), now);
}

TEST(DifferenceFormat, TheSameMap) {
  const MapDifference same = difference(test::small_map(), test::small_map());
  EXPECT_EQ(format_difference_text(same), "the same map: " + same.old_hash + "\n");
  EXPECT_THAT(format_difference_json(same), HasSubstr("\"same\": true"));
  EXPECT_TRUE(what_a_vehicle_notices(same).empty());
}

TEST(DifferenceFormat, JsonIsAsInTheGoldenFile) {
  const MapDifference made = golden();
  EXPECT_EQ(format_difference_json(made), R"({
  "schema": 1,
  "same": false,
  "old": {
    "content_hash": ")" + made.old_hash + R"(",
    "markers": 8,
    "submaps": 2
  },
  "new": {
    "content_hash": ")" + made.new_hash + R"(",
    "markers": 8,
    "submaps": 2
  },
  "submaps": [
    {
      "old": 0,
      "new": 0,
      "common": 5,
      "stayed": [
        3,
        20,
        21,
        22
      ],
      "by_majority": true,
      "old_from_new": {
        "translation_m": [
          -0.5,
          0.0,
          0.0
        ],
        "quaternion_xyzw": [
          0.0,
          0.0,
          0.0,
          1.0
        ]
      },
      "world_shift_m": 0.5,
      "world_turn_deg": 0.0,
      "scale": {
        "old_from_new": 1.0,
        "sigma": 0.0
      },
      "compared_at_scale": 1.0,
      "frame": {
        "old": "scaled",
        "new": "scaled"
      },
      "z_is_up": {
        "old": false,
        "new": true
      },
      "median_sigma_m": {
        "old": 0.00244949,
        "new": 0.00244949
      },
      "stayed_rms_m": 0.0,
      "moved": [
        {
          "id": 586,
          "distance_m": 0.25,
          "offset_m": [
            0.0,
            0.0,
            0.25
          ],
          "sigma_m": 0.00244949,
          "turn_deg": 0.0
        }
      ]
    },
    {
      "old": 1,
      "new": 1,
      "common": 1,
      "stayed": [
        0
      ],
      "by_majority": true,
      "old_from_new": {
        "translation_m": [
          0.0,
          0.0,
          0.0
        ],
        "quaternion_xyzw": [
          0.0,
          0.0,
          0.0,
          1.0
        ]
      },
      "world_shift_m": 0.0,
      "world_turn_deg": 0.0,
      "scale": null,
      "compared_at_scale": 1.0,
      "frame": {
        "old": "arbitrary",
        "new": "arbitrary"
      },
      "z_is_up": {
        "old": false,
        "new": false
      },
      "median_sigma_m": {
        "old": 0.00244949,
        "new": 0.00244949
      },
      "stayed_rms_m": 0.0,
      "moved": []
    }
  ],
  "appeared": [
    5
  ],
  "vanished": [
    7
  ],
  "renamed": [
    {
      "from": 12,
      "to": 13
    }
  ],
  "resized": [
    {
      "id": 3,
      "old_m": 0.12,
      "new_m": 0.125
    }
  ],
  "verified": [],
  "unverified": [],
  "not_compared": [],
  "vehicle": [
    "sub-map 0: another world: poses shift by up to 500.0 mm and turn by 0.000°; waypoints stored in the old map must be moved, or the new one built with --frame-of the old",
    "sub-map 0: z is up now: poses get a yaw",
    "sub-map 1: the world is the old one, to 0.00 mm at its markers",
    "with the old map it finds these moved and leaves them out, with the new one it uses them: 586",
    "new to it, no longer UNKNOWN: 5",
    "no longer used; where they were all it saw it has no pose: 7",
    "used under a new name: 13",
    "of another size, so nearer or farther in the old map than they are: 3",
    "its quarantine ends, for it belongs to the old map"
  ]
}
)");
}

TEST(DifferenceFormat, TextIsAsInTheGoldenFile) {
  const MapDifference made = golden();
  EXPECT_EQ(format_difference_text(made), R"(old )" + made.old_hash + R"(: 8 markers in 2 sub-maps
new )" + made.new_hash + R"(: 8 markers in 2 sub-maps
1 moved, 1 new, 1 gone, 1 renamed, 1 of another size

old sub-map 0, new sub-map 0
  aligned on   4 of 5 common markers: 3, 20-22
  these differ 0.00 mm RMS
  frame        scaled → scaled, z is up
  world        500.00 mm at its markers, 0.000°
  lengths      +0.0 ± 0.0 ppm
  median sigma 2.45 mm → 2.45 mm
  moved 586: 250.0 mm (+0.0, +0.0, +250.0), 102.1 sigmas of 2.45 mm; turned 0.00°

old sub-map 1, new sub-map 1
  aligned on   1 of 1 common markers: 0
  these differ 0.00 mm RMS
  frame        arbitrary → arbitrary
  world        0.00 mm at its markers, 0.000°
  median sigma 2.45 mm → 2.45 mm

new            5
gone           7
renamed        12 → 13
size           0.1200 → 0.1250 m: 3

a vehicle will notice
  - sub-map 0: another world: poses shift by up to 500.0 mm and turn by 0.000°; waypoints stored in the old map must be moved, or the new one built with --frame-of the old
  - sub-map 0: z is up now: poses get a yaw
  - sub-map 1: the world is the old one, to 0.00 mm at its markers
  - with the old map it finds these moved and leaves them out, with the new one it uses them: 586
  - new to it, no longer UNKNOWN: 5
  - no longer used; where they were all it saw it has no pose: 7
  - used under a new name: 13
  - of another size, so nearer or farther in the old map than they are: 3
  - its quarantine ends, for it belongs to the old map
)");
}

TEST(DifferenceFormat, ALevelWorldLostAndGained) {
  MarkerMap level = test::small_map();
  level.submaps[0].z_is_up = true;
  EXPECT_THAT(what_a_vehicle_notices(difference(test::small_map(), level)),
              testing::Contains(HasSubstr("poses get a yaw")));
  EXPECT_THAT(what_a_vehicle_notices(difference(level, test::small_map())),
              testing::Contains(HasSubstr("poses lose yaw")));
}

TEST(DifferenceFormat, TheWorldIsAnotherBeyondTheLimitAlone) {
  for (const double shift_m : {0.0099, 0.0101}) {
    MarkerMap shifted = test::small_map();
    for (MapMarker& marker : shifted.submaps[0].markers) {
      marker.world_from_marker.translation.y() += shift_m;
    }
    const auto notices = what_a_vehicle_notices(difference(test::small_map(), shifted));
    EXPECT_THAT(notices, testing::Contains(HasSubstr(shift_m > 0.01 ? "another world"
                                                                    : "the world is the old one")));
  }
}

TEST(DifferenceFormat, AScaleIsSaidBeyondItsSigmas) {
  const auto notices = [](double factor) {
    MarkerMap old_map;
    old_map.submaps = {test::hall(40, 1)};
    MarkerMap new_map;
    new_map.submaps = {test::hall(40, 2)};
    for (MapMarker& marker : new_map.submaps[0].markers) {
      marker.world_from_marker.translation *= factor;
    }
    return what_a_vehicle_notices(difference(old_map, new_map));
  };
  EXPECT_THAT(notices(1.0), testing::Not(testing::Contains(HasSubstr("lengths differ"))));
  EXPECT_THAT(notices(1.001), testing::Contains(HasSubstr("lengths differ by +")));
}

}  // namespace
}  // namespace waymark
