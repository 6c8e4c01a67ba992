#include "locd/alert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Rig two_cameras() {
  Rig rig;
  rig.cameras.resize(2, RigCamera{"cam0", *CameraModel::create({}), {}, {}, {}, {}, {}, {}});
  rig.cameras[1].name = "cam1";
  return rig;
}

Alert alert_of(AlertKind kind, bool raised) {
  Alert alert;
  alert.kind = kind;
  alert.raised = raised;
  alert.camera = 0;
  alert.other_camera = 1;
  const bool of_marker = kind == AlertKind::marker_moved || kind == AlertKind::marker_unknown ||
                         kind == AlertKind::marker_riding;
  if (of_marker) alert.marker = MarkerId{Family::tag36h11, 12};
  return alert;
}

class EveryKind : public testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] static AlertKind kind() { return static_cast<AlertKind>(GetParam()); }
  [[nodiscard]] static std::string text(bool raised) {
    return alert_text(alert_of(kind(), raised), two_cameras(), false);
  }
};

TEST_P(EveryKind, EndsInWordsOfItsOwnThatAskForNothing) {
  const std::string name(name_of(kind()));
  EXPECT_THAT(text(true), StartsWith(name + ": "));
  EXPECT_THAT(text(false), StartsWith(name + " is over: "));
  const std::string raised = text(true).substr(name.size());
  EXPECT_THAT(text(false), Not(HasSubstr(raised)));
  for (const char* order : {"put it back", "restart", "check", "swap", "clean", "calibrate"}) {
    EXPECT_THAT(text(false), Not(HasSubstr(order)));
  }
}

TEST_P(EveryKind, NeverSaysANumberThatIsNotKnown) {
  for (const bool raised : {true, false}) EXPECT_THAT(text(raised), Not(HasSubstr("nan")));
}

TEST_P(EveryKind, NamesWhomItConcerns) {
  const bool of_all = kind() == AlertKind::map_wrong;
  for (const bool raised : {true, false}) {
    const auto alert = alert_of(kind(), raised);
    EXPECT_THAT(text(raised), HasSubstr(of_all ? "markers" : alert.marker ? "12" : "cam0"));
  }
}

TEST_P(EveryKind, IsTheSameInTheLogWhateverItsFigures) {
  Alert near = alert_of(kind(), true);
  Alert far = near;
  near.offset_m = near.offset_rad = 0.1;
  far.offset_m = far.offset_rad = 0.2;
  EXPECT_EQ(log_key(near, two_cameras(), false), log_key(far, two_cameras(), false));
  far.raised = false;
  EXPECT_NE(log_key(near, two_cameras(), false), log_key(far, two_cameras(), false));
  far = near;
  far.camera = 1;
  far.marker = MarkerId{Family::tag36h11, 13};
  EXPECT_NE(log_key(near, two_cameras(), false), log_key(far, two_cameras(), false));
}

TEST_P(EveryKind, MayBeOverForAMapWasLoaded) {
  Alert alert = alert_of(kind(), false);
  alert.map_loaded = true;
  EXPECT_THAT(alert_text(alert, two_cameras(), false), HasSubstr("a map was loaded"));
}

INSTANTIATE_TEST_SUITE_P(Alert, EveryKind, testing::Range(std::size_t{0}, kAlertKinds));

TEST(Alert, OfAClockIsOfOneCameraOrOfAll) {
  Alert late = alert_of(AlertKind::stamps_skewed, true);
  late.value = -0.0201;
  late.sigma = 0.0003;
  EXPECT_THAT(alert_text(late, two_cameras(), false),
              HasSubstr("cam0's images were taken -20.10 ms"));
  late.camera = -1;
  EXPECT_THAT(alert_text(late, two_cameras(), false),
              HasSubstr("the cameras do not expose together"));
}

TEST(Alert, SaysHowFarWhereThatIsKnown) {
  Alert moved = alert_of(AlertKind::marker_moved, true);
  moved.offset_m = 0.31;
  moved.offset_rad = 0.0349;
  EXPECT_THAT(alert_text(moved, two_cameras(), true),
              HasSubstr("marker tag36h11:12 hangs 0.310 m and 2.0 deg from where the map says"));
  moved.offset_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(alert_text(moved, two_cameras(), true), HasSubstr("hangs elsewhere than where"));
}

TEST(Alert, OneEndsWhatAnotherOfTheSameSubjectRaised) {
  const Alert swap = alert_of(AlertKind::cameras_swapped, true);
  Alert turned = swap;
  std::swap(turned.camera, turned.other_camera);
  EXPECT_TRUE(same_subject(swap, turned));
  turned.other_camera = 2;
  EXPECT_FALSE(same_subject(swap, turned));
  Alert of_another_kind = swap;
  of_another_kind.kind = AlertKind::image_dark;
  EXPECT_FALSE(same_subject(swap, of_another_kind));
}

}  // namespace
}  // namespace waymark
