#include "mapbuilder/commands/improved_rig.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"
#include "tests/support/synthetic_room.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

/// A build of two cameras' images that has told the second one's edges.
class ImprovedRig : public ::testing::Test {
 protected:
  ImprovedRig() {
    Rig rig = test::ring_rig(2);
    for (RigCamera& camera : rig.cameras) camera.stated_sigmas.edge_px.reset();
    result_.estimate.calibration.rigs.push_back(rig);
    observations_.first_camera.push_back(CameraIndex(0));
    observations_.edges.push_back(std::nullopt);
    observations_.edges.push_back(EdgeMeasurement{0.25, 0.0125, SensorResponse::srgb});
    options_.output = folder_.path() / "hall.map";
  }

  Status write() { return write_improved_rigs(options_, result_, observations_, out_, notes_); }

  TemporaryFolder folder_;
  BuildCommandOptions options_;
  BuildResult result_;
  Observations observations_;
  std::ostringstream out_;
  std::ostringstream notes_;
};

TEST_F(ImprovedRig, HoldsWhatImagesTellOfEdges) {
  const Rig rig = improved_rig(RigIndex(0), result_.estimate.calibration, observations_);
  EXPECT_FALSE(rig.cameras[0].edge_bias_px);
  EXPECT_FALSE(rig.cameras[0].response);
  EXPECT_EQ(rig.cameras[1].edge_bias_px, 0.25);
  EXPECT_EQ(rig.cameras[1].stated_sigmas.edge_px, 0.0125);
  EXPECT_EQ(rig.cameras[1].response, SensorResponse::srgb);
}

TEST_F(ImprovedRig, StandsBesideTheMapAndTakesAnEarlierOnesPlace) {
  for (const double bias_px : {0.25, 0.5}) {
    observations_.edges[CameraIndex(1)]->bias_px = bias_px;
    ASSERT_TRUE(write());
    const auto back = read_camchain(folder_.path() / "hall.yaml");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->rig.cameras[1].edge_bias_px, bias_px);
  }
  EXPECT_EQ(notes_.str(), "");
}

// What a calibration says of all its numbers together, says of edges what images told since.
TEST_F(ImprovedRig, IsReadBackWhateverTheRigStatesOfItsErrors) {
  for (const bool stated : {false, true}) {
    Rig& rig = result_.estimate.calibration.rigs[RigIndex(0)];
    const auto count = static_cast<Eigen::Index>(rig_parameters(rig).size());
    rig.joint_sigmas = Eigen::MatrixXd::Identity(count, count);
    for (RigCamera& camera : rig.cameras) camera.stated_sigmas = {};
    if (stated) {
      for (RigCamera& camera : rig.cameras) camera.stated_sigmas.edge_px = 1;
    }
    ASSERT_TRUE(write());
    const auto back = read_camchain(folder_.path() / "hall.yaml");
    ASSERT_TRUE(back) << back.error().message;
    ASSERT_TRUE(back->rig.joint_sigmas);
    EXPECT_EQ(back->rig.cameras[1].stated_sigmas.edge_px, 0.0125);
  }
}

TEST_F(ImprovedRig, LeavesEveryOtherFileThere) {
  const std::string own = format_camchain(test::ring_rig(2));
  const std::string measured =
      format_camchain(improved_rig(RigIndex(0), result_.estimate.calibration, observations_));
  ASSERT_TRUE(write());
  const std::string edited = folder_.read("hall.yaml") + "# mine\n";
  for (const std::string& text :
       {std::string("mine: 1\n"), std::string(), own, measured, edited, std::string("\n")}) {
    notes_.str("");
    folder_.write("hall.yaml", text);
    ASSERT_TRUE(write());
    EXPECT_EQ(folder_.read("hall.yaml"), text);
    EXPECT_NE(notes_.str().find("name it with --refined-rig"), std::string::npos);
  }
  options_.refined_rig = folder_.path() / "asked.yaml";
  ASSERT_TRUE(write());
  EXPECT_TRUE(read_camchain(*options_.refined_rig));
}

TEST_F(ImprovedRig, TakesNoInputsPlace) {
  const Rig rig = improved_rig(RigIndex(0), result_.estimate.calibration, observations_);
  options_.input.rig_yaml = folder_.write("hall.yaml", format_camchain(rig));
  observations_.edges[CameraIndex(1)]->bias_px = 0.5;
  ASSERT_TRUE(write());
  EXPECT_EQ(folder_.read("hall.yaml"), format_camchain(rig));
  EXPECT_NE(notes_.str().find("--refined-rig"), std::string::npos);
}

TEST_F(ImprovedRig, OfNothingToldIsNone) {
  observations_.edges[CameraIndex(1)].reset();
  ASSERT_TRUE(write());
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "hall.yaml"));
}

TEST_F(ImprovedRig, IsAskedForByRefinementOrByName) {
  EXPECT_FALSE(asked_rig_path(options_));
  options_.build.refine.intrinsics = true;
  EXPECT_EQ(asked_rig_path(options_), folder_.path() / "hall.yaml");
  options_.refined_rig = "there.yaml";
  EXPECT_EQ(asked_rig_path(options_), "there.yaml");
}

}  // namespace
}  // namespace waymark
