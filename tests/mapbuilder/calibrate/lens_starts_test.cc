#include "mapbuilder/calibrate/lens_starts.h"

#include "mapbuilder/diagnosis/square_equations.h"
#include "tests/mapbuilder/calibrate/unknown_room.h"

namespace waymark {
namespace {

TEST(LensStarts, BeginWithWhatTheHomographiesTell) {
  const auto room = test::noisy_room(1);
  const auto capture = test::capture_of_unknown_rig(room);
  const auto starts = lens_starts(capture.rig.cameras[0].model.parameters(), Distortion::radtan,
                                  outlines_of(capture, 0))
                          .lenses;
  ASSERT_FALSE(starts.empty());
  const double truth_px = room.rig.cameras[0].model.parameters().fu_px;
  EXPECT_NEAR(starts.front().fu_px / truth_px, 1, 0.1);
  EXPECT_EQ(starts.front().distortion, Distortion::radtan);
}

TEST(LensStarts, GoOnFromWhatIsStatedAndWithOtherFocalLengths) {
  CameraParameters known = test::ring_rig(1).cameras[0].model.parameters();
  known.distortion = Distortion::equidistant;
  known.fu_px = known.fv_px = 470;
  const auto starts = lens_starts(known, Distortion::equidistant, {}).lenses;
  ASSERT_GT(starts.size(), 3U);
  EXPECT_EQ(starts.front(), known);
  for (const CameraParameters& start : starts) {
    EXPECT_EQ(start.distortion, Distortion::equidistant);
    EXPECT_EQ(start.width_px, known.width_px);
  }
}

TEST(LensStarts, OfFewMarkersAreMiddlingLenses) {
  const auto known = test::unknown_lens(test::ring_rig(1).cameras[0].model).parameters();
  const auto starts = lens_starts(known, Distortion::radtan, {}).lenses;
  ASSERT_FALSE(starts.empty());
  EXPECT_EQ(starts.front().fu_px, 1280);
}

}  // namespace
}  // namespace waymark
