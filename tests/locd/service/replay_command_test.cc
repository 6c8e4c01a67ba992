#include "locd/service/replay_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/camera/rig_fingerprint.h"
#include "core/capture/detections_csv_text.h"
#include "core/capture/pgm.h"
#include "core/estimate/consider_parameters.h"
#include "core/geometry/tum.h"
#include "core/map/map_file.h"
#include "core/marker/marker_outline.h"
#include "tests/support/room_capture.h"
#include "tests/support/room_map.h"

namespace waymark {
namespace {

using testing::HasSubstr;

class ReplayCommand : public testing::Test {
 protected:
  ReplayCommand() {
    test::RoomOptions options;
    options.frame_sets = 60;
    options.noise_px = 0.1;
    options.state_covariances = true;
    room_ = test::make_room(options);
    test::write_room_capture(folder_, room_);
    EXPECT_TRUE(write_map_file(folder_.path() / "room.map", test::room_map(room_)));
  }

  Status run(const std::string& trajectory) {
    ReplayCommandOptions options;
    options.capture = folder_.path();
    options.map = folder_.path() / "room.map";
    options.trajectory = folder_.path() / trajectory;
    options.table = folder_.path() / (trajectory + ".csv");
    return run_replay(options, stop_, out_, notes_);
  }

  TemporaryFolder folder_;
  test::SyntheticRoom room_;
  std::atomic<bool> stop_{false};
  std::ostringstream out_;
  std::ostringstream notes_;
};

TEST_F(ReplayCommand, WritesEverySetsPoseAtItsOwnStamp) {
  const auto status = run("a.tum");
  ASSERT_TRUE(status) << status.error().message;
  const auto poses = read_tum(folder_.path() / "a.tum");
  ASSERT_TRUE(poses);
  ASSERT_EQ(poses->size(), 60U);
  for (std::size_t i = 0; i < poses->size(); ++i) {
    EXPECT_EQ((*poses)[i].key, format_stamp_s(test::room_stamp(static_cast<int>(i))));
    EXPECT_LT((*poses)[i].pose.minus(room_.world_from_rig[i]).norm(), 0.01);
  }
  EXPECT_EQ(out_.str(), "60 frame sets: 60 OK, 0 DEGRADED, 0 AMBIGUOUS, 0 LOST\n");
}

TEST_F(ReplayCommand, GivesTheSameBytesEachTime) {
  ASSERT_TRUE(run("a.tum"));
  ASSERT_TRUE(run("b.tum"));
  EXPECT_EQ(folder_.read("a.tum"), folder_.read("b.tum"));
  EXPECT_EQ(folder_.read("a.tum.csv"), folder_.read("b.tum.csv"));
}

TEST_F(ReplayCommand, AStopEndsItWithWhatThereIs) {
  stop_ = true;
  ASSERT_TRUE(run("a.tum"));
  EXPECT_EQ(out_.str(), "0 frame sets: 0 OK, 0 DEGRADED, 0 AMBIGUOUS, 0 LOST\n");
}

TEST_F(ReplayCommand, ARigWithoutTransformsIsRefused) {
  std::string rig = folder_.read("rig.yaml");
  for (std::size_t at = 0; (at = rig.find("  T_c")) != std::string::npos;) {
    std::size_t end = at;
    for (int line = 0; line < 5; ++line) end = rig.find('\n', end) + 1;
    rig.erase(at, end - at);
  }
  // Nor how sure they are.
  for (std::size_t at = 0; (at = rig.find("  sigma: ")) != std::string::npos;) {
    rig.erase(at, rig.find('\n', at) + 1 - at);
  }
  ASSERT_NE(rig, folder_.read("rig.yaml")) << "one camera only";
  folder_.write("rig.yaml", rig);
  const auto status = run("a.tum");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::bad_data);
  EXPECT_NE(status.error().message.find("T_cn_cnm1"), std::string::npos) << status.error().message;
}

/// The capture with its frame sets so many ms apart.
void play_faster(TemporaryFolder& folder, const test::SyntheticRoom& room, int period_ms) {
  auto images = room.images;
  for (ImageDetections& image : images) {
    const auto set =
        (image.stamp - test::room_stamp(0)) / (test::room_stamp(1) - test::room_stamp(0));
    image.stamp = test::room_stamp(0) + set * Stamp(std::chrono::milliseconds(period_ms));
  }
  folder.write("detections.csv",
               format_detections_csv(images, room.rig, room.catalog, "synthetic"));
}

// At 200 and more images a second the sync tolerance reaches the next frame.
TEST_F(ReplayCommand, FastCamerasFramesArePairedRightlyAndThatIsSaid) {
  for (const int period_ms : {5, 4, 2, 1}) {
    play_faster(folder_, room_, period_ms);
    out_.str("");
    notes_.str("");
    const auto status = run("a.tum");
    ASSERT_TRUE(status) << status.error().message;
    EXPECT_THAT(out_.str(), HasSubstr("60 frame sets: ")) << period_ms << notes_.str();
    EXPECT_THAT(out_.str(), testing::Not(HasSubstr("CAMERA_MISSING"))) << period_ms;
    EXPECT_THAT(notes_.str(), HasSubstr(fmt::format("frames come every {}.000 ms", period_ms)));
    EXPECT_THAT(notes_.str(), testing::Not(HasSubstr("came into no pose")));
  }
}

TEST_F(ReplayCommand, FramesThatComeIntoNoSetAreCountedWithTheReason) {
  auto images = room_.images;
  ImageDetections twice = images[0];
  twice.stamp += std::chrono::milliseconds(1);
  images.push_back(twice);  // before the other cameras' first, so that it takes the place
  for (ImageDetections& image : images) {
    if (image.camera != twice.camera) image.stamp += std::chrono::milliseconds(2);
  }
  folder_.write("detections.csv",
                format_detections_csv(images, room_.rig, room_.catalog, "synthetic"));
  ASSERT_TRUE(run("a.tum"));
  EXPECT_THAT(notes_.str(), HasSubstr("note: frames that came into no pose: overtaken 1 ("));
}

TEST_F(ReplayCommand, SaysWhatIsWrong) {
  std::filesystem::remove(folder_.path() / "room.map");
  EXPECT_EQ(run("a.tum").error().kind, ErrorKind::no_input);
  folder_.write("room.map", "no map");
  EXPECT_EQ(run("a.tum").error().kind, ErrorKind::bad_data);
  EXPECT_EQ(folder_.read("a.tum"), "");
}

TEST_F(ReplayCommand, ReplacesNothingThatItReadsAndWritesNoTwoToOneFile) {
  folder_.write("cam0/1700000000000000000.jpg", "as it was");
  folder_.write("groundtruth/rig.tum", "as it was");
  folder_.write("sfm.toml", "as it was");
  std::filesystem::create_symlink("room.map", folder_.path() / "link");
  for (const char* name :
       {"room.map", "./room.map", "link", "rig.yaml", "markers.toml", "detections.csv",
        "cam0/1700000000000000000.jpg", "groundtruth/rig.tum", "sfm.toml", "once.csv"}) {
    const std::string before = folder_.read(name);
    ReplayCommandOptions options;
    options.capture = folder_.path();
    options.map = folder_.path() / "room.map";
    options.trajectory = folder_.path() / name;
    options.table = folder_.path() / "once.csv";
    for (int i = 0; i < 2; ++i) {
      const auto status = run_replay(options, stop_, out_, notes_);
      ASSERT_FALSE(status) << name;
      EXPECT_EQ(status.error().kind, ErrorKind::usage) << status.error().message;
      EXPECT_EQ(folder_.read(name), before) << name;
      std::swap(options.trajectory, options.table);
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "once.csv"));
}

TEST_F(ReplayCommand, WhatCannotBeWrittenIsSaidBeforeTheWork) {
  const auto status = run("absent/a.tum");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::cant_create);
  EXPECT_EQ(out_.str(), "");
}

/// Images alone: the detections are taken away.
TEST_F(ReplayCommand, ImagesThatCanNotBeUsedAreSaid) {
  std::filesystem::remove(folder_.path() / "detections.csv");
  for (int i = 0; i < 20; ++i) {
    for (std::size_t camera = 0; camera < room_.rig.cameras.size(); ++camera) {
      folder_.write(fmt::format("{}/{}.pgm", room_.rig.cameras[camera].name, i * 50'000'000),
                    i % 2 == 0 ? "" : "P5 3 3 255\n123456789");
    }
  }
  const Status none = run("none.tum");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::bad_data);
  EXPECT_NE(none.error().message.find("no image of"), std::string::npos) << none.error().message;
  EXPECT_NE(none.error().message.find("the first: "), std::string::npos) << none.error().message;
  for (const char* output : {"none.tum", "none.tum.csv"}) {
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / output)) << "nothing half-done is left";
  }

  const CameraParameters& camera = room_.rig.cameras[0].model.parameters();
  folder_.write(fmt::format("{}/{}.pgm", room_.rig.cameras[0].name, 0),
                encode_pgm(GrayImage(camera.width_px, camera.height_px).view()));
  const Status some = run("some.tum");
  ASSERT_TRUE(some) << some.error().message;
  EXPECT_NE(notes_.str().find("images left out; the first: "), std::string::npos) << notes_.str();
}

/// The room's map by this rig's calibration, built with edges as sure as that (px).
MarkerMap map_with_edges(const test::SyntheticRoom& room, double sigma_px) {
  MarkerMap map = test::room_map(room);
  map.rig_fingerprint = fingerprint(room.rig);
  SubMap& submap = map.submaps[0];
  for (MapMarker& marker : submap.markers) {
    marker.covariance = marker.covariance_metric = 1e-8 * Matrix6d::Identity();
  }
  const std::span<const Rig> rigs(&room.rig, 1);
  const ConsiderParameters all =
      consider_parameters(rigs, std::vector<StatedSize>{{submap.markers[0].size_m, 0.001}});
  submap.parameters.clear();
  submap.parameter_covariance = all.covariance;
  for (Eigen::Index i = 0; i < all.count(); ++i) {
    const ConsiderParameter& one = all.all[static_cast<std::size_t>(i)];
    submap.parameters.emplace_back().name = name_of(one, rigs);
    if (one.is_size() || one.of_rig.quantity != CameraQuantity::edge) continue;
    submap.parameter_covariance.row(i).setZero();
    submap.parameter_covariance.col(i).setZero();
    submap.parameter_covariance(i, i) = sigma_px * sigma_px;
  }
  return map;
}

// Images of a webcam show its edges up to 0.4 px inside the black.
TEST_F(ReplayCommand, MeasuredEdgesThatTheRigFileLacksAreWarnedOfAndPosesContainThem) {
  for (RigCamera& camera : room_.rig.cameras) camera.stated_sigmas = {};
  const auto written = write_map_file(folder_.path() / "room.map", map_with_edges(room_, 0.005));
  ASSERT_TRUE(written) << written.error().message;
  for (const double inside_px : {0.0, 0.2, 0.354, 0.4}) {
    test::SyntheticRoom seen = room_;
    for (ImageDetections& image : seen.images) {
      for (Detection& detection : image.detections) move_sides_in(inside_px, detection.corners);
    }
    test::write_room_capture(folder_, seen);
    out_.str("");
    notes_.str("");
    ASSERT_TRUE(run("a.tum"));
    EXPECT_THAT(out_.str(), HasSubstr(" 0 AMBIGUOUS, 0 LOST\n")) << inside_px;
    EXPECT_THAT(notes_.str(), HasSubstr("warning: "));
    EXPECT_THAT(notes_.str(), HasSubstr("edges are seen by cam0, cam1, cam2 was measured"));
    EXPECT_THAT(notes_.str(), HasSubstr("room.yaml"));
    EXPECT_THAT(notes_.str(), testing::Not(HasSubstr("set "))) << "nobody is accused";
  }
  for (RigCamera& camera : room_.rig.cameras) {
    camera.edge_bias_px = 0;
    camera.stated_sigmas.edge_px = 0.005;
  }
  test::write_room_capture(folder_, room_);
  notes_.str("");
  ASSERT_TRUE(run("a.tum"));
  EXPECT_THAT(notes_.str(), testing::Not(HasSubstr("warning")));
}

TEST_F(ReplayCommand, SumsUpWhyPosesAreNotOk) {
  MarkerMap map = test::room_map(room_);
  for (MapMarker& marker : map.submaps[0].markers) marker.covariance = unknown_covariance();
  ASSERT_TRUE(write_map_file(folder_.path() / "room.map", map));
  ASSERT_TRUE(run("a.tum"));
  EXPECT_THAT(out_.str(), HasSubstr("60 frame sets: 0 OK, 60 DEGRADED"));
  EXPECT_THAT(out_.str(), HasSubstr("not OK because of SIGMA 60"));
}

}  // namespace
}  // namespace waymark
