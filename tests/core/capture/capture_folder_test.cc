#include "core/capture/capture_folder.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/support/as_nobody.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kHeader = "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n";

/// A capture folder that lacks only images and detections; opening never decodes an image.
class Capture : public testing::Test {
 protected:
  void make(int cameras) const {
    folder_.write("rig.yaml", tiny_rig_yaml(cameras));
    folder_.write("markers.toml", tiny_markers_toml());
  }

  [[nodiscard]] Expected<CaptureFolder> open() const { return open_capture_folder(folder_.path()); }

  [[nodiscard]] CaptureFolder good() const {
    auto capture = open();
    EXPECT_TRUE(capture) << capture.error().message;
    return capture ? std::move(*capture) : CaptureFolder();
  }

  /// Fails unless opening fails this way, in one line.
  void expect_failure(ErrorKind kind, const std::string& message) const {
    const auto capture = open();
    ASSERT_FALSE(capture) << "expected: " << message;
    EXPECT_EQ(capture.error().kind, kind) << capture.error().message;
    EXPECT_THAT(capture.error().message, HasSubstr(message));
    EXPECT_EQ(capture.error().message.find('\n'), std::string::npos);
  }

  TemporaryFolder folder_;
};

TEST_F(Capture, ImagesOfSeveralCamerasByStampThenCamera) {
  make(2);
  folder_.write("cam1/1511000000000000000.PNG", "");
  folder_.write("cam0/1511000000000000000.jpg", "");
  folder_.write("cam0/999.pgm", "");
  const CaptureFolder capture = good();
  ASSERT_EQ(capture.images.size(), 3U);
  EXPECT_EQ(capture.images[0].stamp.count(), 999);
  EXPECT_EQ(capture.images[1].camera, 0);
  EXPECT_EQ(capture.images[2].camera, 1);
  EXPECT_EQ(capture.images[2].path, folder_.path() / "cam1/1511000000000000000.PNG");
  EXPECT_TRUE(capture.stamps_from_names);
  EXPECT_EQ(capture.rig.cameras.size(), 2U);
  EXPECT_EQ(capture.catalog.only_family(), Family::tag36h11);
  EXPECT_EQ(capture.sync_tolerance, std::chrono::milliseconds(5));
  EXPECT_FALSE(capture.detections_csv);
  EXPECT_FALSE(capture.survey_toml);
  EXPECT_THAT(capture.notes, IsEmpty());
}

TEST_F(Capture, DetectionsAloneWillDo) {
  make(2);
  folder_.write("detections.csv", kHeader);
  folder_.write("survey.toml", "");
  const CaptureFolder capture = good();
  EXPECT_THAT(capture.images, IsEmpty());
  EXPECT_EQ(capture.detections_csv, folder_.path() / "detections.csv");
  EXPECT_EQ(capture.survey_toml, folder_.path() / "survey.toml");
}

TEST_F(Capture, CaptureTomlIsRead) {
  make(1);
  folder_.write("detections.csv", kHeader);
  folder_.write("capture.toml",
                "clock = \"monotonic\"\nsession = \"a1\"\nsync_tolerance_us = 1500\n"
                "codec = \"pgm\"\nsoftware = \"locd 1.0\"\n");
  const CaptureFolder capture = good();
  EXPECT_EQ(capture.session, "a1");
  EXPECT_EQ(capture.sync_tolerance, std::chrono::microseconds(1500));
  EXPECT_TRUE(capture.monotonic);
}

TEST_F(Capture, AnOptionalFileThatIsALinkToNothingIsNotAbsent) {
  make(1);
  folder_.write("detections.csv", kHeader);
  for (const char* target : {"capture.toml", "nothing-there"}) {  // in a circle, nowhere
    std::filesystem::create_symlink(target, folder_.path() / "capture.toml");
    expect_failure(ErrorKind::no_input, "capture.toml: can't open");
    std::filesystem::remove(folder_.path() / "capture.toml");
  }
  EXPECT_TRUE(open());
}

TEST_F(Capture, WrongCaptureTomlIsBadData) {
  make(1);
  folder_.write("detections.csv", kHeader);
  for (const char* text :
       {"clock = \"gps\"\n", "session = 3\n", "sync_tolerance_us = -1\n",
        "sync_tolerance_us = 1000001\n", "sync_tolerance_us = 1.5\n", "x = \n",
        "sync_tolerance = 3000\n", "Clock = \"monotonic\"\n", "[clock]\n", "codec = 3\n"}) {
    folder_.write("capture.toml", text);
    expect_failure(ErrorKind::bad_data, "capture.toml: line 1: ");
  }
  for (const char* text : {"sync_tolerance_us = 0\n", "sync_tolerance_us = 1000000\n"}) {
    folder_.write("capture.toml", text);
    EXPECT_TRUE(open());
  }
}

TEST_F(Capture, MonoNamesThatAreNoStampsAreSortedOneSecondApart) {
  make(1);
  folder_.write("cam0/b.jpg", "");
  folder_.write("cam0/a.jpg", "");
  folder_.write("cam0/IMG_0001.jpg", "");
  const CaptureFolder capture = good();
  EXPECT_FALSE(capture.stamps_from_names);
  ASSERT_EQ(capture.images.size(), 3U);
  EXPECT_EQ(capture.images[0].path.filename(), "IMG_0001.jpg");
  EXPECT_EQ(capture.images[2].path.filename(), "b.jpg");
  EXPECT_EQ(capture.images[0].stamp, std::chrono::seconds(0));
  EXPECT_EQ(capture.images[2].stamp, std::chrono::seconds(2));
  EXPECT_THAT(capture.notes, ElementsAre(HasSubstr("names are no stamps")));
}

TEST_F(Capture, NamesThatAreNoStampsNeedASingleCamera) {
  make(2);
  folder_.write("cam0/5.jpg", "");
  folder_.write("cam1/left.jpg", "");
  expect_failure(ErrorKind::bad_data, "cam1/left.jpg: the name is no stamp");
}

TEST_F(Capture, OneNameThatIsNoStampAmongStampsIsBadData) {
  make(1);
  folder_.write("cam0/5.jpg", "");
  folder_.write("cam0/6 (copy).jpg", "");
  expect_failure(ErrorKind::bad_data, "6 (copy).jpg: the name is no stamp");
}

TEST_F(Capture, TwoImagesWithOneStampAreBadData) {
  make(1);
  folder_.write("cam0/5.jpg", "");
  folder_.write("cam0/5.png", "");
  expect_failure(ErrorKind::bad_data, "cam0/5.jpg and 5.png: two images of one camera");
}

TEST_F(Capture, CameraFolderWithoutEntryInTheRigIsBadData) {
  make(1);
  folder_.write("cam0/5.jpg", "");
  folder_.write("cam1/5.jpg", "");
  expect_failure(ErrorKind::bad_data, "folder cam1 has no entry in rig.yaml");
}

TEST_F(Capture, RigEntryWithoutCameraFolderIsBadData) {
  make(2);
  folder_.write("cam0/5.jpg", "");
  expect_failure(ErrorKind::bad_data, "rig.yaml names cam1, but there is no folder cam1");
}

TEST_F(Capture, OtherFilesAndFoldersArePassedOver) {
  make(1);
  folder_.write("cam0/5.jpg", "");
  folder_.write("cam0/.hidden.jpg", "");
  folder_.write("cam0/Thumbs.db", "");
  folder_.write("cam0/5.bmp", "");
  folder_.write("camera_notes/readme.txt", "");
  folder_.write("cam1", "a file, not a folder");
  folder_.write("groundtruth/rig.tum", "");
  const CaptureFolder capture = good();
  EXPECT_EQ(capture.images.size(), 1U);
  EXPECT_THAT(capture.notes, ElementsAre(HasSubstr("2 of 3 files are no jpg, png or pgm")));
}

TEST_F(Capture, CameraWithoutImagesIsNoted) {
  make(2);
  folder_.write("cam0/5.jpg", "");
  fs::create_directory(folder_.path() / "cam1");
  EXPECT_THAT(good().notes, Contains(HasSubstr("cam1: no images")));
}

TEST_F(Capture, EmptyCaptureIsNoInput) {
  make(1);
  expect_failure(ErrorKind::no_input, "empty capture: neither images");
  fs::create_directory(folder_.path() / "cam0");
  expect_failure(ErrorKind::no_input, "empty capture: neither images");
  folder_.write("cam0/readme.txt", "");
  expect_failure(ErrorKind::no_input, "empty capture: neither images");
}

TEST_F(Capture, AbsentFolderIsNoInput) {
  const auto absent = open_capture_folder(folder_.path() / "absent");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::no_input);
  EXPECT_THAT(absent.error().message, HasSubstr("absent: no such capture folder"));
  EXPECT_EQ(open_capture_folder(folder_.write("file", "")).error().kind, ErrorKind::no_input);
}

TEST_F(Capture, AFolderThatMayNotBeLookedAtIsAPermissionErrorNotAnAbsentOne) {
  folder_.write("closed/room/rig.yaml", tiny_rig_yaml(1));
  fs::permissions(folder_.path() / "closed", fs::perms::none);
  {
    const test::AsNobody nobody;
    if (nobody.applies()) {
      const auto opened = open_capture_folder(folder_.path() / "closed/room");
      ASSERT_FALSE(opened);
      EXPECT_EQ(opened.error().kind, ErrorKind::permission);
      EXPECT_THAT(opened.error().message, HasSubstr("closed/room: can't look at it"));
    }
  }
  fs::permissions(folder_.path() / "closed", fs::perms::owner_all);
}

TEST_F(Capture, AbsentRigOrMarkersIsNoInput) {
  folder_.write("cam0/5.jpg", "");
  expect_failure(ErrorKind::no_input, "rig.yaml");
  folder_.write("rig.yaml", tiny_rig_yaml(1));
  expect_failure(ErrorKind::no_input, "markers.toml");
}

TEST_F(Capture, UnreadableRigOrMarkersIsBadData) {
  make(1);
  folder_.write("cam0/5.jpg", "");
  folder_.write("markers.toml", "[markers]\nfamily = \"tag36h11\"\nsize_m = -1\n");
  expect_failure(ErrorKind::bad_data, "markers.toml");
  folder_.write("rig.yaml", "cam0: [\n");
  expect_failure(ErrorKind::bad_data, "rig.yaml");
}

TEST_F(Capture, FolderThatMayNotBeListedIsAPermissionError) {
  make(1);
  folder_.write("cam0/5.jpg", "");
  fs::permissions(folder_.path() / "cam0", fs::perms::none);
  fs::permissions(folder_.path(), fs::perms::all);
  {
    const test::AsNobody nobody;
    ASSERT_TRUE(nobody.applies());
    expect_failure(ErrorKind::permission, "cam0: can't list the folder");
  }
  fs::permissions(folder_.path() / "cam0", fs::perms::owner_all);
}

}  // namespace
}  // namespace waymark
