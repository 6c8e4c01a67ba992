#include "core/capture/rig_of_frames.h"

#include <gtest/gtest.h>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

constexpr const char* kMarkers = "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.2\n";

class RigOfFrames : public testing::Test {
 protected:
  RigOfFrames() { folder_.write("markers.toml", kMarkers); }

  void add_image(const std::string& name, int width, int height) {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    ASSERT_TRUE(write_gray_image(folder_.path() / name, GrayImage(width, height, 128).view()));
  }
  [[nodiscard]] Expected<CaptureFolder> open() const {
    return open_capture_folder(folder_.path(), RigFile::optional);
  }

  TemporaryFolder folder_;
};

TEST_F(RigOfFrames, TakesCamerasByFolderAndSizesByImages) {
  add_image("cam0/1000000000000000000.pgm", 64, 48);
  add_image("cam1/1000000000000000000.pgm", 80, 60);
  const auto capture = open();
  ASSERT_TRUE(capture) << capture.error().message;
  ASSERT_EQ(capture->rig.cameras.size(), 2U);
  EXPECT_FALSE(capture->rig.has_extrinsics);
  const CameraParameters& p = capture->rig.cameras[1].model.parameters();
  EXPECT_EQ(capture->rig.cameras[1].name, "cam1");
  EXPECT_EQ(p.width_px, 80);
  EXPECT_EQ(p.height_px, 60);
  EXPECT_EQ(p.pu_px, 39.5);
  EXPECT_EQ(capture->images.size(), 2U);
}

TEST_F(RigOfFrames, TakesCamerasByNamesInDetectionsAndSaysWhichSizeItAssumes) {
  folder_.write("detections.csv",
                "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n"
                "1000000000000000000,cam0,3,10,10,1270,12,1270,1000,10,1000\n"
                "1000000000000000000,cam1,,,,,,,,,\n");
  const auto capture = open();
  ASSERT_TRUE(capture) << capture.error().message;
  ASSERT_EQ(capture->rig.cameras.size(), 2U);
  EXPECT_EQ(capture->rig.cameras[0].model.parameters().width_px, 1280);
  EXPECT_EQ(capture->rig.cameras[0].model.parameters().height_px, 1024);
  ASSERT_FALSE(capture->notes.empty());
  EXPECT_NE(capture->notes.front().find("1280×1024"), std::string::npos);
}

TEST_F(RigOfFrames, OneCamerasPlaceIsTheRigs) {
  add_image("cam0/1000000000000000000.pgm", 64, 48);
  const auto capture = open();
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_TRUE(capture->rig.has_extrinsics);
}

TEST_F(RigOfFrames, RefusesGapsAndNothingAtAll) {
  EXPECT_EQ(open().error().kind, ErrorKind::no_input);
  add_image("cam0/1000000000000000000.pgm", 64, 48);
  add_image("cam2/1000000000000000000.pgm", 64, 48);
  const auto gap = open();
  ASSERT_FALSE(gap);
  EXPECT_EQ(gap.error().kind, ErrorKind::bad_data);
  EXPECT_NE(gap.error().message.find("gaps"), std::string::npos);
}

TEST_F(RigOfFrames, IsAskedForOnlyWhereARigFileIsOptional) {
  add_image("cam0/1000000000000000000.pgm", 64, 48);
  EXPECT_EQ(open_capture_folder(folder_.path()).error().kind, ErrorKind::no_input);
  folder_.write("cam0/1000000000000000001.pgm", "not an image");
  EXPECT_TRUE(open());
}

}  // namespace
}  // namespace waymark
