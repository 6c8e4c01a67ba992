#include "mapbuilder/diagnosis/baseline_units.h"

#include <gmock/gmock.h>

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

using testing::HasSubstr;

test::SyntheticRoom room(int cameras = 3, double turn_rad = -1) {
  test::RoomOptions options;
  options.noise_px = 0.2;
  options.cameras = cameras;
  options.turn_in_place_rad = turn_rad;
  return test::make_room(options);
}

/// What is found where the rig file's translations are so many times too long.
std::vector<Finding> found(test::SyntheticRoom room, double translations, double sizes = 1) {
  for (RigCamera& camera : room.rig.cameras) camera.rig_from_cam.translation *= translations;
  auto entries = room.catalog.entries();
  *entries.front().default_size_m *= sizes;
  room.catalog = MarkerCatalog(entries);
  return baseline_findings(test::observations_of(room));
}

TEST(BaselineUnits, EveryUnitIsNamed) {
  for (const auto& [factor, unit] :
       {std::pair{1000.0, "in millimetres?"}, {100.0, "in centimetres?"}, {39.37, "in inches?"}}) {
    for (const int cameras : {2, 3, 4}) {
      const auto findings = found(room(cameras), factor);
      ASSERT_FALSE(findings.empty()) << unit << " " << cameras;
      for (const Finding& finding : findings) {
        EXPECT_EQ(finding.severity, Severity::error);
        EXPECT_EQ(finding.cause, Cause::rig_unit);
        EXPECT_THAT(finding.text, HasSubstr(unit));
        EXPECT_NEAR(finding.figures.front().value, 1 / factor, 0.25 / factor);
      }
    }
  }
}

TEST(BaselineUnits, SizesInAnotherUnitAreNotTakenForBaselines) {
  const auto findings = found(room(), 1, 100);
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].cause, Cause::size_scale);
  EXPECT_THAT(findings[0].text, HasSubstr("in centimetres?"));
}

TEST(BaselineUnits, SoundRigsAndOtherFaultsAreNoQuestionOfUnits) {
  for (const double translations : {1.0, 0.8, 1.25, 2.0}) {
    for (const double sizes : {1.0, 0.8, 1.25}) {
      EXPECT_TRUE(found(room(), translations, sizes).empty()) << translations << " " << sizes;
    }
  }
  EXPECT_TRUE(found(room(1), 1).empty());
}

TEST(BaselineUnits, ARigThatHardlyTurnsTellsNothingAndIsAskedAbout) {
  // It stands still: nobody can tell 10 m from 10 cm.
  EXPECT_TRUE(found(room(3, 0.0), 1).empty());
  const auto findings = found(room(3, 0.0), 100);
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].severity, Severity::warning);
  EXPECT_THAT(findings[0].text, HasSubstr("The images do not tell"));
}

}  // namespace
}  // namespace waymark
