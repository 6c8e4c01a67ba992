#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "mapbuilder/diagnosis/diagnosed_build.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark::test {

inline constexpr int kFrameSets = 60;

inline SyntheticRoom noisy_room(int cameras = 3) {
  RoomOptions options;
  options.markers = 30;
  options.frame_sets = kFrameSets;
  options.cameras = cameras;
  options.noise_px = 0.1;
  return make_room(options);
}

/// Lets `change` look at every detection: false takes it out.
inline void edit(SyntheticRoom& room, const std::function<bool(Detection&, Stamp)>& change) {
  for (ImageDetections& image : room.images) {
    std::erase_if(image.detections, [&](Detection& d) { return !change(d, image.stamp); });
  }
}

inline void take_down(SyntheticRoom& room, int id) {
  edit(room, [&](Detection& d, Stamp) { return d.marker.number != id; });
}

/// The same walk an hour later.
inline SyntheticRoom an_hour_later(SyntheticRoom room) {
  for (ImageDetections& image : room.images) image.stamp += std::chrono::hours(1);
  return room;
}

/// The pose moved by metres in the marker's own plane and turned about its normal.
inline Rigid3 shifted(const Rigid3& pose, double right_m, double up_m, double turn_rad = 0) {
  return pose * Rigid3{so3_exp({0, 0, turn_rad}), {right_m, up_m, 0}};
}

/// Builds and diagnoses a room.
class DiagnosedRoom : public ::testing::Test {
 protected:
  void build(std::vector<DetectedCapture> captures, const ObservationOptions& options = {}) {
    auto made = make_observations(captures, options);
    ASSERT_TRUE(made) << made.error().message;
    observations_ = std::move(*made);
    build_ = build_and_diagnose(observations_, {}, {}, progress_);
    ASSERT_FALSE(build_.result.submaps.empty());
  }
  void build(const SyntheticRoom& room) { build({capture_of(room)}); }

  [[nodiscard]] const MapMarker* mapped(int id) const {
    for (const MapMarker& marker : build_.result.map.submaps.front().markers) {
      if (marker.id.number == id) return &marker;
    }
    return nullptr;
  }

  /// Largest error (m) of mapped distances between markers that are not to be looked at.
  [[nodiscard]] double worst_distance_m(const SyntheticRoom& room,
                                        const std::vector<int>& without) const {
    double worst = 0;
    const auto& markers = build_.result.map.submaps.front().markers;
    const auto skipped = [&](const MapMarker& m) {
      return std::find(without.begin(), without.end(), m.id.number) != without.end();
    };
    for (const MapMarker& a : markers) {
      for (const MapMarker& b : markers) {
        if (skipped(a) || skipped(b)) continue;
        const auto at = [&](const MapMarker& m) {
          return room.world_from_marker[static_cast<std::size_t>(m.id.number)].translation;
        };
        worst = std::max(
            worst,
            std::abs((a.world_from_marker.translation - b.world_from_marker.translation).norm() -
                     (at(a) - at(b)).norm()));
      }
    }
    return worst;
  }

  [[nodiscard]] double figure(const char* name) const {
    for (const Figure& figure : build_.findings.front().figures) {
      if (figure.name == name) return figure.value;
    }
    ADD_FAILURE() << "no figure " << name;
    return 0;
  }

  [[nodiscard]] std::string titles() const {
    std::string all;
    for (const Finding& finding : build_.findings) all += one_line(finding) + "\n";
    return all;
  }

  void expect_nobody() const { EXPECT_TRUE(build_.findings.empty()) << titles(); }

  /// Exactly one finding, of this cause, about this marker.
  void expect_only(Cause cause, int id) const {
    ASSERT_EQ(build_.findings.size(), 1u) << titles();
    EXPECT_EQ(build_.findings.front().cause, cause) << titles();
    ASSERT_EQ(build_.findings.front().markers.size(), 1u);
    EXPECT_EQ(build_.findings.front().markers.front().number, id);
  }

  Progress progress_{false};
  Observations observations_;
  DiagnosedBuild build_;
};

}  // namespace waymark::test
