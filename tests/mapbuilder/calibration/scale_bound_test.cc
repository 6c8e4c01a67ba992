#include "mapbuilder/calibration/scale_bound.h"

#include "core/marker/marker_outline.h"
#include "mapbuilder/build/map_builder.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

constexpr double kBias_px = 0.3;

BuildResult build(const Observations& observations, const BuildOptions& options = {}) {
  Progress progress(false);
  return build_map(Selection(observations), options, progress);
}

/// Root mean square of the markers' distances from their middle.
double size_of(const SubMap& map) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const MapMarker& marker : map.markers) {
    middle += marker.world_from_marker.translation / static_cast<double>(map.markers.size());
  }
  double squared = 0;
  for (const MapMarker& marker : map.markers) {
    squared += (marker.world_from_marker.translation - middle).squaredNorm();
  }
  return std::sqrt(squared / static_cast<double>(map.markers.size()));
}

TEST(ScaleBound, IsWhatEdgesThatAreSeenFurtherOutDoToTheMap) {
  test::RoomOptions options;
  options.cameras = 1;
  options.noise_px = 0.05;
  auto room = test::make_room(options);
  const auto observations = test::observations_of(room);
  const BuildResult plain = build(observations);
  ASSERT_EQ(plain.submaps.at(0).scale_per_edge_px.size(), 1U);
  const double predicted = kBias_px * plain.submaps[0].scale_per_edge_px.front();
  // Markers look larger, so everything is taken to be nearer.
  EXPECT_LT(predicted, -1e-4);
  for (ImageDetections& image : room.images) {
    for (Detection& d : image.detections) {
      const auto outward = outward_of(d.corners);
      for (std::size_t i = 0; i < 4; ++i) d.corners[i] += kBias_px * outward[i];
    }
  }
  const auto biased_observations = test::observations_of(room);
  const BuildResult biased = build(biased_observations);
  const double happened = size_of(biased.submaps.at(0).map) / size_of(plain.submaps[0].map) - 1.0;
  EXPECT_NEAR(happened, predicted, 0.15 * std::abs(predicted));
}

TEST(ScaleBound, IsNotSaidWhereALengthWasMeasured) {
  test::RoomOptions options;
  options.noise_px = 0.2;
  const auto room = test::make_room(options);
  const auto observations = test::observations_of(room);
  BuildOptions surveyed;
  const double true_m =
      (room.world_from_marker[0].translation - room.world_from_marker[20].translation).norm();
  surveyed.survey.distances = {{{{Family::tag36h11, 0}, std::nullopt},
                                {{Family::tag36h11, 20}, std::nullopt},
                                true_m,
                                0.001,
                                SurveyUse::fit}};
  EXPECT_TRUE(build(observations, surveyed).submaps.at(0).scale_per_edge_px.empty());
}

}  // namespace
}  // namespace waymark
