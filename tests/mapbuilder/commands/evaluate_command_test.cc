#include "mapbuilder/commands/evaluate_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/geometry/tum.h"
#include "core/map/map_export.h"
#include "core/map/map_file.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const Rigid3 kTruthFromMap{so3_exp({0.5, 1, -0.25}), {3, -2, 1}};

constexpr const char* kRig =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [500, 500, 320, 240]\n  distortion_model: none\n"
    "  resolution: [640, 480]\n"
    "cam1:\n  camera_model: pinhole\n  intrinsics: [500, 500, 320, 240]\n  distortion_model: none\n"
    "  resolution: [640, 480]\n"
    "  T_cn_cnm1: [[0, 0, 1, 0.1], [0, 1, 0, 0.2], [-1, 0, 0, 0.3], [0, 0, 0, 1]]\n";

/// A capture's true poses, a map of it, and what a build would have written.
class EvaluateCommand : public ::testing::Test {
 protected:
  EvaluateCommand() {
    EXPECT_TRUE(write_map_file(folder_.path() / "a.map", map_));
    SubMap truth = map_.submaps[0];
    for (MapMarker& marker : truth.markers) {
      marker.world_from_marker = kTruthFromMap * marker.world_from_marker;
    }
    folder_.write("capture/groundtruth/markers.tum", format_submap_tum(truth, false));
    for (int i = 0; i < 6; ++i) {
      const Rigid3 map_from_rig{so3_exp({0, 0.2 * i, 0}), Eigen::Vector3d(i, i * i, 0)};
      map_from_rig_.push_back(map_from_rig);
      truth_.push_back({stamp(i), kTruthFromMap * map_from_rig});
    }
    folder_.write("capture/groundtruth/rig.tum", format_tum(truth_));
    folder_.write("capture/rig.yaml", kRig);
  }

  static std::string stamp(int i) {
    return format_stamp_s(Stamp(1'511'000'000'000'000'000 + 50'000'000LL * i));
  }

  /// Writes map_from_rig ∘ rig_from_frame of every second set.
  std::filesystem::path write_trajectory(const std::string& name, const Rigid3& rig_from_frame) {
    std::vector<TumPose> poses;
    for (int i = 0; i < 6; i += 2) {
      poses.push_back({stamp(i), map_from_rig_[static_cast<std::size_t>(i)] * rig_from_frame});
    }
    return folder_.write(name, format_tum(poses));
  }

  Status run(bool json, std::optional<std::filesystem::path> trajectory = std::nullopt) {
    out_.str("");
    return run_evaluate({folder_.path() / "a.map", std::move(trajectory),
                         folder_.path() / "capture/groundtruth", json},
                        out_);
  }

  test::TemporaryFolder folder_;
  const MarkerMap map_ = test::small_map();
  std::vector<Rigid3> map_from_rig_;
  std::vector<TumPose> truth_;
  std::ostringstream out_;
};

TEST_F(EvaluateCommand, MarkersAlone) {
  const auto status = run(true);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("\"found\": 3"), HasSubstr("\"cameras\": null"),
                                HasSubstr("\"aligned_on\": \"centres\"")));
  // The second sub-map's markers are not among the true ones.
  EXPECT_THAT(out_.str(), HasSubstr("\"found\": 0"));
}

TEST_F(EvaluateCommand, ARigsTrajectory) {
  const auto status = run(false, write_trajectory("rig.tum", {}));
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("cameras: 3 of 6; 0.00 mm, 0.0000° RMSE"),
                                HasSubstr("carried by the markers' alignment: 0.00 mm, 0.0000°")));
}

TEST_F(EvaluateCommand, MonoTrajectoriesAreOfCameras) {
  const Rigid3 cam1_from_cam0{Eigen::Quaterniond(so3_exp({0, M_PI / 2, 0})), {0.1, 0.2, 0.3}};
  write_trajectory("mono.cam0.tum", {});
  write_trajectory("mono.cam1.tum", cam1_from_cam0.inverse());
  auto status = run(false, folder_.path() / "mono.tum");
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("cameras: 6 of 12; 0.00 mm, 0.0000° RMSE"),
                                HasSubstr("carried by the markers' alignment: 0.00 mm, 0.0000°")));
  status = run(false, folder_.path() / "mono.cam1.tum");
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_THAT(out_.str(), HasSubstr("cameras: 3 of 6; 0.00 mm, 0.0000° RMSE"));

  std::filesystem::remove(folder_.path() / "capture/rig.yaml");
  status = run(false, folder_.path() / "mono.tum");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::no_input);
  EXPECT_THAT(status.error().message, HasSubstr("poses of cameras"));
}

TEST_F(EvaluateCommand, WhatHasNothingInCommonIsBadData) {
  folder_.write("capture/groundtruth/markers.tum", "77 0 0 0 0 0 0 1\n");
  auto status = run(true);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(status.error().message, HasSubstr("no marker of the map"));
  std::filesystem::remove(folder_.path() / "capture/groundtruth/markers.tum");
  status = run(true, folder_.write("other.tum", "1.5 0 0 0 0 0 0 1\n"));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(status.error().message, HasSubstr("within 1 ms"));
  EXPECT_EQ(out_.str(), "");
}

TEST_F(EvaluateCommand, AbsentInputsAreNoInput) {
  auto status = run(true, folder_.path() / "absent.tum");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::no_input);
  std::filesystem::remove(folder_.path() / "capture/groundtruth/rig.tum");
  status = run(true, write_trajectory("rig.tum", {}));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::no_input);
  EXPECT_THAT(status.error().message, HasSubstr("groundtruth/rig.tum"));
  std::filesystem::remove(folder_.path() / "capture/groundtruth/markers.tum");
  status = run(true);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::no_input);
}

}  // namespace
}  // namespace waymark
