#include "mapbuilder/import/lcm_capture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/camera/kalibr.h"
#include "core/camera/rig_fingerprint.h"
#include "core/capture/capture_folder.h"
#include "core/capture/detections_csv.h"
#include "tests/support/lcm_log_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using testing::HasSubstr;

class LcmCapture : public testing::Test {
 protected:
  /// A log by a locd with this rig.
  std::filesystem::path log(const std::string& rig_fingerprint) {
    std::string text;
    for (int set = 0; set < 3; ++set) {
      detections_t message = test::detections_message(set);
      message.rig = rig_fingerprint;
      text += test::lcm_event("WAYMARK_DETECTIONS", test::encoded(message));
    }
    return folder_.write("a.lcm", text);
  }

  Status import(const LcmCaptureOptions& options) {
    Progress progress(false);
    return import_lcm_log(options, progress, out_, notes_);
  }

  const TemporaryFolder folder_;
  const std::filesystem::path rig_ = folder_.write("r.yaml", tiny_rig_yaml(3));
  const std::filesystem::path markers_ = folder_.write("m.toml", tiny_markers_toml());
  std::ostringstream out_;
  std::ostringstream notes_;
};

TEST_F(LcmCapture, IsTheLogWithItsRig) {
  const auto capture = folder_.path() / "room";
  const std::string rig = fingerprint(read_camchain(rig_)->rig);
  const auto imported = import({log(rig), capture, {rig_, markers_}, {}});
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(notes_.str(), "");
  EXPECT_THAT(out_.str(), HasSubstr("3 frame sets of 3 cameras, 3 markers"));
  EXPECT_EQ(folder_.read("room/rig.yaml"), tiny_rig_yaml(3));
  const auto opened = open_capture_folder(capture);
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ(opened->session, "0123456789abcdef");
  const auto table = read_detections_csv(*opened->detections_csv, opened->rig, opened->catalog);
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_EQ(table->images.size(), 6U) << "images in which nothing was found, too";
  ASSERT_EQ(table->images[0].detections.size(), 1U);
  EXPECT_TRUE(table->images[0].detections[0].covariances);
}

TEST_F(LcmCapture, SaysWhatIsMissing) {
  ASSERT_TRUE(import({log(""), folder_.path() / "room", {}, {}}));
  EXPECT_THAT(notes_.str(), HasSubstr("put rig.yaml there"));
  EXPECT_THAT(notes_.str(), HasSubstr("put markers.toml there"));
}

TEST_F(LcmCapture, AnotherRigIsRefusedAndNothingWritten) {
  const auto refused = import({log("0000000000000000"), folder_.path() / "room", {rig_, {}}, {}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(refused.error().message, HasSubstr("not the rig file that locd had"));
  const auto two = folder_.write("two.yaml", tiny_rig_yaml(2));
  EXPECT_THAT(import({log(""), folder_.path() / "room", {two, {}}, {}}).error().message,
              HasSubstr("2 cameras, but locd's rig had 3"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "room"));
}

}  // namespace
}  // namespace waymark
