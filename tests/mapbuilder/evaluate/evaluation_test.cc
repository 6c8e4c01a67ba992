#include "mapbuilder/evaluate/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/small_map.h"

namespace waymark {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const MarkerId kFirst{Family::tag36h11, 3};
const MarkerId kSecond{Family::tag36h11, 12};
const MarkerId kThird{Family::tag36h11, 586};
const MarkerId kUnmapped{Family::tag36h11, 100};

/// The first sub-map's own poses in another frame, and one marker more.
std::map<MarkerId, Rigid3> truth_of(const SubMap& submap, const Rigid3& truth_from_map) {
  std::map<MarkerId, Rigid3> truth;
  for (const MapMarker& marker : submap.markers) {
    truth[marker.id] = truth_from_map * marker.world_from_marker;
  }
  truth[kUnmapped] = Rigid3{};
  return truth;
}

TEST(EvaluateMarkers, FindsAlignsAndNamesWhatIsMissing) {
  const SubMap submap = test::small_map().submaps[0];
  const Rigid3 truth_from_map{so3_exp({1, 2, 0.5}), {-4, 0, 9}};
  auto truth = truth_of(submap, truth_from_map);
  truth.erase(kThird);
  const MarkerEvaluation markers = evaluate_markers(submap, truth);
  EXPECT_EQ(markers.truth, 3U);
  EXPECT_THAT(markers.found, ElementsAre(kFirst, kSecond));
  EXPECT_THAT(markers.missing, ElementsAre(kUnmapped));
  ASSERT_TRUE(markers.errors);
  EXPECT_TRUE(markers.errors->positions_on_a_line);
  EXPECT_LT(markers.errors->rmse.translation_m, 1e-13);
  EXPECT_LT(markers.errors->truth_from_estimate.minus(truth_from_map).norm(), 1e-12);
}

TEST(EvaluateMarkers, NothingFoundHasNoErrors) {
  const MarkerEvaluation markers =
      evaluate_markers(test::small_map().submaps[1], {{kUnmapped, Rigid3{}}});
  EXPECT_THAT(markers.found, IsEmpty());
  EXPECT_FALSE(markers.errors);
}

TEST(EvaluateCameras, InTheMapTheyAreCarriedByTheMarkers) {
  const SubMap submap = test::small_map().submaps[0];
  const Rigid3 truth_from_map{so3_exp({1, 2, 0.5}), {-4, 0, 9}};
  const MarkerEvaluation markers = evaluate_markers(submap, truth_of(submap, truth_from_map));
  MatchedPoses poses;
  poses.truth = 5;
  for (int i = 0; i < 4; ++i) {
    const Rigid3 pose{so3_exp({0.1 * i, 0, 0}), Eigen::Vector3d(i, i * i, 0)};
    Rigid3 shifted = pose;
    shifted.translation.x() += 0.005;
    poses.pairs.push_back({shifted, truth_from_map * pose});
  }
  const CameraEvaluation cameras = evaluate_cameras(poses, &markers);
  EXPECT_EQ(cameras.truth, 5U);
  EXPECT_EQ(cameras.found, 4U);
  EXPECT_LT(cameras.errors->rmse.translation_m, 1e-12);
  EXPECT_NEAR(cameras.rmse_in_map->translation_m, 0.005, 1e-12);
  EXPECT_NEAR(cameras.rmse_in_map->rotation_rad, 0, 1e-12);
  EXPECT_FALSE(evaluate_cameras(poses, nullptr).rmse_in_map);
}

std::vector<SubMapEvaluation> example() {
  PoseAccuracy markers;
  markers.rmse = {0.0025, 0.001};
  markers.scale = 1.0005;
  markers.sim3_translation_rmse_m = 0.002;
  markers.each = {{0.003, 0.0012}, {0.0019, 0.0007}};
  PoseAccuracy cameras;
  cameras.positions_on_a_line = true;
  cameras.rmse = {0.001, 0.0001};
  cameras.sim3_translation_rmse_m = 0.001;
  SubMapEvaluation first;
  first.markers = MarkerEvaluation{3, {kFirst, kSecond}, {kUnmapped}, markers};
  first.cameras = CameraEvaluation{10, 9, cameras, PoseRmse{0.0015, 0.0002}};
  SubMapEvaluation second;
  second.markers = MarkerEvaluation{3, {}, {kFirst, kSecond, kUnmapped}, std::nullopt};
  return {first, second};
}

TEST(EvaluationJson, GoldenForm) {
  EXPECT_EQ(format_evaluation_json(example(), false), R"({
  "schema": 1,
  "submaps": [
    {
      "markers": {
        "truth": 3,
        "found": 2,
        "missing": [
          100
        ],
        "translation_rmse_m": 0.0025,
        "rotation_rmse_deg": 0.05729578,
        "scale": 1.0005,
        "sim3_translation_rmse_m": 0.002,
        "aligned_on": "centres",
        "each": [
          {
            "id": 3,
            "translation_m": 0.003,
            "rotation_deg": 0.068754935
          },
          {
            "id": 12,
            "translation_m": 0.0019,
            "rotation_deg": 0.040107046
          }
        ]
      },
      "cameras": {
        "truth": 10,
        "found": 9,
        "translation_rmse_m": 0.001,
        "rotation_rmse_deg": 0.005729578,
        "scale": 1.0,
        "sim3_translation_rmse_m": 0.001,
        "aligned_on": "poses"
      },
      "cameras_in_map": {
        "truth": 10,
        "found": 9,
        "translation_rmse_m": 0.0015,
        "rotation_rmse_deg": 0.011459156
      }
    },
    {
      "markers": {
        "truth": 3,
        "found": 0,
        "missing": [
          3,
          12,
          100
        ],
        "translation_rmse_m": null,
        "rotation_rmse_deg": null,
        "scale": null,
        "sim3_translation_rmse_m": null,
        "aligned_on": null,
        "each": []
      },
      "cameras": null,
      "cameras_in_map": null
    }
  ]
}
)");
}

TEST(EvaluationJson, IdsNameTheirFamilyWhereSeveralMeet) {
  EXPECT_THAT(format_evaluation_json(example(), true), HasSubstr(R"("id": "tag36h11:12")"));
}

TEST(EvaluationText, GoldenForm) {
  EXPECT_EQ(
      format_evaluation_text(example(), false),
      "sub-map 0\n"
      "  markers: 2 of 3; 2.50 mm, 0.0573° RMSE after SE(3); scale 1.000500, Sim(3) 2.00 mm\n"
      "  missing: 100\n"
      "  worst markers:\n"
      "                 3      3.00 mm   0.0688°\n"
      "                12      1.90 mm   0.0401°\n"
      "  cameras: 9 of 10; 1.00 mm, 0.0057° RMSE after SE(3); scale 1.000000, Sim(3) 1.00 mm\n"
      "  the cameras' positions lie on a line: their poses are aligned\n"
      "  cameras, carried by the markers' alignment: 1.50 mm, 0.0115°\n"
      "sub-map 1\n"
      "  markers: 0 of 3; nothing to compare\n"
      "  missing: 3 12 100\n");
}

}  // namespace
}  // namespace waymark
