#include "mapbuilder/commands/calibrate_command.h"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/room_capture.h"

namespace waymark {
namespace {

class CalibrateCommand : public testing::Test {
 protected:
  CalibrateCommand() {
    test::RoomOptions room;
    room.cameras = 2;
    room.noise_px = 0.1;
    test::write_room_capture(folder_, test::make_room(room));
    std::filesystem::remove(folder_.path() / "rig.yaml");
  }

  Status run(const std::filesystem::path& output) {
    CalibrateCommandOptions options;
    options.input.paths = {folder_.path()};
    options.output = output;
    Progress progress(false);
    out_.str("");
    notes_.str("");
    return run_calibrate(options, progress, out_, notes_);
  }
  [[nodiscard]] std::filesystem::path path(const char* name) const {
    return results_.path() / name;
  }

  TemporaryFolder folder_;
  TemporaryFolder results_;
  std::ostringstream out_, notes_;
};

TEST_F(CalibrateCommand, WritesARigWithSigmasAndSaysWhereImagesAreCovered) {
  const Status done = run(path("rig.yaml"));
  ASSERT_TRUE(done) << done.error().message << notes_.str();
  const auto rig = read_camchain(path("rig.yaml"));
  ASSERT_TRUE(rig) << rig.error().message;
  ASSERT_EQ(rig->rig.cameras.size(), 2U);
  EXPECT_TRUE(rig->rig.has_extrinsics);
  EXPECT_TRUE(rig->rig.joint_sigmas);
  EXPECT_EQ(rig->rig.cameras[1].sigma_source, SigmaSource::refined);
  EXPECT_NEAR(rig->rig.cameras[1].model.parameters().fu_px, 640, 2);
  EXPECT_NE(out_.str().find("cam1: markers cover"), std::string::npos) << out_.str();
}

TEST_F(CalibrateCommand, MayGiveTheCaptureTheRigFileThatItLacksAndReplacesNoneThatItReads) {
  const Status done = run(folder_.path() / "rig.yaml");
  ASSERT_TRUE(done) << done.error().message;
  const std::string first = folder_.read("rig.yaml");
  const Status again = run(folder_.path() / "rig.yaml");
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, ErrorKind::usage);
  EXPECT_EQ(folder_.read("rig.yaml"), first);
}

TEST_F(CalibrateCommand, LeavesWhatStandsThereWhenItFails) {
  ASSERT_TRUE(run(path("rig.yaml")));
  const std::string good = results_.read("rig.yaml");
  folder_.write("detections.csv", "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n");
  const Status failed = run(path("rig.yaml"));
  ASSERT_FALSE(failed);
  EXPECT_EQ(results_.read("rig.yaml"), good);
}

TEST_F(CalibrateCommand, TakesFoldersOnly) {
  CalibrateCommandOptions options;
  options.input.paths = {folder_.path() / "detections.csv"};
  options.output = path("rig.yaml");
  Progress progress(false);
  const Status refused = run_calibrate(options, progress, out_, notes_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace waymark
