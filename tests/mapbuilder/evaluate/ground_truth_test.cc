#include "mapbuilder/evaluate/ground_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;

constexpr const char* kPose = " 1 2 3 0 0 0 1\n";

class GroundTruthFolder : public ::testing::Test {
 protected:
  [[nodiscard]] Expected<GroundTruth> read() const {
    return read_ground_truth(folder_.path(), Family::tag36h11);
  }
  test::TemporaryFolder folder_;
};

TEST_F(GroundTruthFolder, HoldsMarkersAndStampedPoses) {
  folder_.write("markers.tum", std::string("12") + kPose + "tag25h9:3" + kPose);
  folder_.write("rig.tum", std::string("2.5") + kPose + "-1" + kPose);
  const auto truth = read();
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_TRUE(truth->world_from_marker->contains({Family::tag36h11, 12}));
  EXPECT_TRUE(truth->world_from_marker->contains({Family::tag25h9, 3}));
  ASSERT_EQ(truth->world_from_rig->size(), 2U);
  EXPECT_EQ(truth->world_from_rig->at(0).stamp, std::chrono::seconds(-1));
  EXPECT_EQ(truth->world_from_rig->at(1).stamp, std::chrono::milliseconds(2500));
}

TEST_F(GroundTruthFolder, MayHoldOnlyOneOfThem) {
  folder_.write("rig.tum", std::string("1") + kPose);
  const auto truth = read();
  ASSERT_TRUE(truth);
  EXPECT_FALSE(truth->world_from_marker);
  EXPECT_TRUE(truth->world_from_rig);
}

TEST_F(GroundTruthFolder, MayBeOneOfThePapersDataSets) {
  folder_.write("marker_gt.txt", std::string("12") + kPose);
  folder_.write("cam_gt.txt", std::string("0") + kPose + "1" + kPose);
  const auto truth = read();
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_EQ(truth->world_from_marker->size(), 1U);
  EXPECT_EQ(truth->world_from_rig->size(), 2U);
}

TEST_F(GroundTruthFolder, WithoutEitherIsNoInput) {
  const auto truth = read();
  ASSERT_FALSE(truth);
  EXPECT_EQ(truth.error().kind, ErrorKind::no_input);
}

TEST_F(GroundTruthFolder, RepeatedOrSenselessKeysAreBadData) {
  const auto refusal = [&](const char* file, const std::string& text) {
    folder_.write(file, text);
    const auto truth = read();
    EXPECT_FALSE(truth);
    if (truth) return std::string();
    EXPECT_EQ(truth.error().kind, ErrorKind::bad_data);
    return truth.error().message;
  };
  EXPECT_THAT(refusal("rig.tum", std::string("now") + kPose), HasSubstr("rig.tum: 'now'"));
  EXPECT_THAT(refusal("rig.tum", std::string("1.0") + kPose + "1" + kPose),
              HasSubstr("rig.tum: two poses at 1.000000000 s"));
  EXPECT_THAT(refusal("markers.tum", std::string("587") + kPose), HasSubstr("markers.tum: "));
  EXPECT_THAT(refusal("markers.tum", std::string("door") + kPose), HasSubstr("markers.tum: "));
  EXPECT_THAT(refusal("markers.tum", std::string("5") + kPose + "tag36h11:5" + kPose),
              HasSubstr("markers.tum: marker tag36h11:5 stands there twice"));
}

TEST_F(GroundTruthFolder, BareNumbersMeanNothingWhereFamiliesMeet) {
  folder_.write("markers.tum", std::string("12") + kPose);
  EXPECT_FALSE(read_ground_truth(folder_.path(), std::nullopt));
}

}  // namespace
}  // namespace waymark
