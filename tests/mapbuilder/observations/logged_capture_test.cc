#include "mapbuilder/observations/logged_capture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/camera/kalibr.h"
#include "tests/support/lcm_log_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using testing::HasSubstr;

detections_t message_of(int set, const std::string& rig) {
  detections_t m = test::detections_message(set);
  m.rig = rig;
  m.count = 3;
  m.camera = {0, 0, 2};
  m.family = {"tag36h11", "tag36h11", "aruco_4x4_50"};
  m.marker_id = {12, 99, 3};  // tiny_markers_toml ignores 99 and lacks the other family
  m.corners_px.resize(3, m.corners_px[0]);
  m.covariances_px2.resize(3, m.covariances_px2[0]);
  m.verdict = {0, 3, 3};
  return m;
}

class LoggedCaptureTest : public testing::Test {
 protected:
  Expected<DetectedCapture> take(const std::string& rig) {
    std::string log;
    for (int set = 0; set < 4; ++set) {
      log += test::lcm_event("WAYMARK_DETECTIONS", test::encoded(message_of(set, rig)));
    }
    Progress progress(false);
    return take_logged_capture({folder_.write("a.lcm", log), rig_, markers_}, progress, report_);
  }

  const TemporaryFolder folder_;
  const std::filesystem::path rig_ = folder_.write("r.yaml", tiny_rig_yaml(3));
  const std::filesystem::path markers_ = folder_.write("m.toml", tiny_markers_toml());
  DetectionReport report_;
};

TEST_F(LoggedCaptureTest, HasTheMarkersThatTheCatalogKnows) {
  const auto capture = take(fingerprint(read_camchain(rig_)->rig));
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_EQ(capture->images.size(), 8U);
  EXPECT_EQ(report_.images, 8U);
  EXPECT_EQ(report_.detections, 4U);
  ASSERT_EQ(capture->images[0].detections.size(), 1U);
  EXPECT_EQ(capture->images[0].detections[0].marker.number, 12);
  EXPECT_EQ(capture->unlisted.size(), 1U);
  ASSERT_EQ(report_.warnings.size(), 1U);
  EXPECT_THAT(report_.warnings[0], HasSubstr("8 detections left out"));
}

TEST_F(LoggedCaptureTest, AnotherRigIsRefused) {
  const auto refused = take("0000000000000000");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(refused.error().message, HasSubstr("not the rig file that locd had"));
}

}  // namespace
}  // namespace waymark
