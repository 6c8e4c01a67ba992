#include "mapbuilder/evaluate/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "mapbuilder/build/output_paths.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;

constexpr const char* kPose = " 1 2 3 0 0 0 1\n";

TEST(OutputPaths, SubMapsAndCamerasStandBesideTheNamedFile) {
  EXPECT_EQ(path_of_submap("out/rig.tum", 0), "out/rig.tum");
  EXPECT_EQ(path_of_submap("out/rig.tum", 2), "out/rig.2.tum");
  EXPECT_EQ(path_of_submap("a.b.tum", 1), "a.b.1.tum");
  EXPECT_EQ(path_of_submap("plain", 1), "plain.1");
  EXPECT_EQ(path_of_camera(path_of_submap("out/rig.tum", 1), "cam3"), "out/rig.1.cam3.tum");
}

std::vector<std::optional<std::string>> cameras_of(const std::filesystem::path& path,
                                                   std::size_t submap) {
  const auto trajectories = read_trajectories(path, submap);
  EXPECT_TRUE(trajectories);
  std::vector<std::optional<std::string>> cameras;
  for (const Trajectory& trajectory : *trajectories) cameras.push_back(trajectory.camera);
  return cameras;
}

TEST(TrajectoryFiles, TheRigsOwnOrOnePerCamera) {
  using Cameras = std::vector<std::optional<std::string>>;
  const test::TemporaryFolder folder;
  const std::string text = std::string("1") + kPose;
  folder.write("rig.tum", text);
  folder.write("rig.1.tum", text);
  for (const int camera : {0, 2, 10}) {
    folder.write("mono.cam" + std::to_string(camera) + ".tum", text);
  }
  folder.write("mono.1.cam2.tum", text);
  folder.write("mono.camera.tum", text);
  EXPECT_EQ(cameras_of(folder.path() / "rig.tum", 0), Cameras{std::nullopt});
  EXPECT_EQ(cameras_of(folder.path() / "rig.tum", 1), Cameras{std::nullopt});
  EXPECT_EQ(cameras_of(folder.path() / "rig.tum", 2), Cameras{});
  EXPECT_EQ(cameras_of(folder.path() / "mono.tum", 0), (Cameras{"cam0", "cam2", "cam10"}));
  EXPECT_EQ(cameras_of(folder.path() / "mono.tum", 1), Cameras{"cam2"});
  EXPECT_EQ(cameras_of(folder.path() / "mono.cam2.tum", 0), Cameras{"cam2"});
  EXPECT_EQ(cameras_of(folder.path() / "mono.cam2.tum", 1), Cameras{"cam2"});
  EXPECT_EQ(cameras_of(folder.path() / "absent.tum", 0), Cameras{});
}

TEST(TrajectoryFiles, DamagedOnesAreBadData) {
  const test::TemporaryFolder folder;
  const auto trajectories = read_trajectories(folder.write("rig.tum", "1 2 3\n"), 0);
  ASSERT_FALSE(trajectories);
  EXPECT_EQ(trajectories.error().kind, ErrorKind::bad_data);
}

Stamp at_us(std::int64_t us) { return std::chrono::microseconds(us); }

Rigid3 pose_at(double x) { return {Eigen::Quaterniond::Identity(), {x, 0, 0}}; }

TEST(TrajectoryFiles, WhatCantBeLookedIntoIsSaidAndThrowsNothing) {
  const test::TemporaryFolder folder;
  std::filesystem::create_symlink("loop", folder.path() / "loop");
  for (const char* name : {"loop", "loop/rig.tum"}) {
    const auto read = read_trajectories(folder.path() / name, 0);
    ASSERT_FALSE(read) << name;
    EXPECT_EQ(read.error().kind, ErrorKind::no_input) << name;
  }
  if (::geteuid() == 0) return;  // the superuser may look everywhere
  folder.write("closed/rig.tum", std::string("1") + kPose);
  std::filesystem::permissions(folder.path() / "closed", std::filesystem::perms::none);
  const auto read = read_trajectories(folder.path() / "closed" / "rig.tum", 0);
  std::filesystem::permissions(folder.path() / "closed", std::filesystem::perms::owner_all);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::permission);
}

TEST(MatchWithTruth, TakesTheNearestTruePoseWithinAMillisecond) {
  const std::vector<StampedPose> truth{
      {at_us(0), pose_at(0)}, {at_us(1500), pose_at(1)}, {at_us(9000), pose_at(2)}};
  const std::vector<Trajectory> estimate{{std::nullopt,
                                          {{at_us(-1001), pose_at(10)},
                                           {at_us(-1000), pose_at(11)},
                                           {at_us(740), pose_at(12)},
                                           {at_us(760), pose_at(13)},
                                           {at_us(10'000), pose_at(14)},
                                           {at_us(10'001), pose_at(15)}}}};
  const auto matched = match_with_truth(estimate, truth, nullptr);
  ASSERT_TRUE(matched);
  EXPECT_EQ(matched->truth, 3U);
  std::vector<std::pair<double, double>> pairs;
  for (const PosePair& pair : matched->pairs) {
    pairs.emplace_back(pair.estimate.translation.x(), pair.truth.translation.x());
  }
  EXPECT_EQ(pairs, (std::vector<std::pair<double, double>>{{11, 0}, {12, 0}, {13, 1}, {14, 2}}));
}

TEST(MatchWithTruth, StampsOfTodayAreTakenToTheNanosecond) {
  const Stamp today(1'511'000'000'000'000'001);
  const std::vector<StampedPose> truth{{today, {}}};
  const auto matched = [&](Stamp stamp) {
    return match_with_truth({{std::nullopt, {{stamp, {}}}}}, truth, nullptr)->pairs.size();
  };
  EXPECT_EQ(matched(today + Stamp(1'000'000)), 1U);
  EXPECT_EQ(matched(today + Stamp(1'000'001)), 0U);
}

TEST(MatchWithTruth, ACamerasTruthIsTheRigsWithItsPlaceOnIt) {
  const auto model = CameraModel::create({640, 480, 500, 500, 320, 240, Distortion::none, {}});
  ASSERT_TRUE(model);
  Rig rig;
  rig.cameras.push_back({"cam0", *model, {}, {}, {}, {}, {}, {}});
  const Rigid3 rig_from_cam1{so3_exp({0, 1, 0}), {0.5, 0, 0}};
  rig.cameras.push_back({"cam1", *model, rig_from_cam1, {}, {}, {}, {}, {}});
  const Rigid3 world_from_rig{so3_exp({0, 0, 1}), {1, 2, 3}};
  const std::vector<StampedPose> truth{{at_us(0), world_from_rig}, {at_us(5000), world_from_rig}};
  const auto matched = match_with_truth({{"cam1", {{at_us(0), {}}}}, {"cam0", {}}}, truth, &rig);
  ASSERT_TRUE(matched);
  EXPECT_EQ(matched->truth, 4U);
  ASSERT_EQ(matched->pairs.size(), 1U);
  EXPECT_LT(matched->pairs[0].truth.minus(world_from_rig * rig_from_cam1).norm(), 1e-15);

  const auto unknown = match_with_truth({{"cam7", {}}}, truth, &rig);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(unknown.error().message, HasSubstr("cam7"));
}

TEST(MatchWithTruth, StampsMayLieAsFarApartAsStampsCan) {
  const std::vector<StampedPose> truth{{Stamp::min(), {}}, {Stamp::max() - Stamp(1), {}}};
  const auto matched = [&](Stamp stamp) {
    return match_with_truth({{std::nullopt, {{stamp, {}}}}}, truth, nullptr)->pairs.size();
  };
  EXPECT_EQ(matched(Stamp(0)), 0U);
  EXPECT_EQ(matched(Stamp::min()), 1U);
  EXPECT_EQ(matched(Stamp::max()), 1U);
}

}  // namespace
}  // namespace waymark
