#include "core/capture/capture_files.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

class CaptureFiles : public testing::Test {
 protected:
  CaptureFiles() {
    for (const char* file : {"cap/rig.yaml", "cap/detections.csv", "cap/cam0/1.jpg",
                             "cap/images/cam1/2.png", "cap/groundtruth/rig.tum", "cap/other/x",
                             "cap/camera/x", "outside/3.jpg", "outside/rig.tum"}) {
      folder_.write(file, "x");
    }
    fs::create_directories(folder_.path() / "cap/cam12");
  }

  [[nodiscard]] bool is_of_capture(const fs::path& path,
                                   CaptureDetections detections = CaptureDetections::kept) const {
    return is_capture_file(folder_.path() / path, folder_.path() / "cap", detections);
  }

  test::TemporaryFolder folder_;
};

TEST_F(CaptureFiles, AreKnownByTheirNamesBeTheyThereOrNot) {
  for (const char* name : {"rig.yaml", "markers.toml", "detections.csv", "capture.toml",
                           "frames.csv", "survey.toml", "sfm.toml", "calib.json", "marker_gt.txt",
                           "cam_gt.txt", "./rig.yaml", "../cap/survey.toml", "."}) {
    EXPECT_TRUE(is_of_capture(fs::path("cap") / name)) << name;
  }
  for (const char* name : {"a.map", "a.tum", "rig2.yaml", "other/rig.yaml", "../rig.yaml"}) {
    EXPECT_FALSE(is_of_capture(fs::path("cap") / name)) << name;
  }
}

TEST_F(CaptureFiles, AreAllThatLiesAmongImagesAndTruth) {
  for (const char* name : {"cam0/1.jpg", "cam0/new.jpg", "cam12/new", "cam0/deeper/new",
                           "images/cam1/2.png", "images/new", "groundtruth/new"}) {
    EXPECT_TRUE(is_of_capture(fs::path("cap") / name)) << name;
  }
  for (const char* name : {"other/x", "camera/x", "cam0/../a.tum", "cam3.tum"}) {
    EXPECT_FALSE(is_of_capture(fs::path("cap") / name)) << name;
  }
}

TEST_F(CaptureFiles, AreKnownUnderTheirOtherNames) {
  const fs::path root = folder_.path();
  EXPECT_FALSE(is_of_capture("outside/3.jpg"));
  fs::create_symlink(root / "outside/3.jpg", root / "cap/cam0/3.jpg");
  EXPECT_TRUE(is_of_capture("outside/3.jpg")) << "an image that lies elsewhere";
  fs::create_hard_link(root / "cap/images/cam1/2.png", root / "hard");
  EXPECT_TRUE(is_of_capture("hard"));
  fs::create_symlink("cap/rig.yaml", root / "link");
  EXPECT_TRUE(is_of_capture("link"));
  fs::create_directory_symlink("cap/cam0", root / "way");
  EXPECT_TRUE(is_of_capture("way/new.jpg"));
  fs::create_directory_symlink(root / "outside", root / "cap/cam7");
  EXPECT_TRUE(is_of_capture("outside/new.jpg")) << "a camera's folder that lies elsewhere";
  folder_.write("far/4.png", "x");
  EXPECT_FALSE(is_of_capture("far/4.png"));
  fs::create_directory_symlink(root / "far", root / "cap/images/cam3");
  EXPECT_TRUE(is_of_capture("far/4.png"));
  EXPECT_TRUE(is_of_capture("far/new.png"));
}

TEST_F(CaptureFiles, DetectionsMayBeWhatIsMadeOfIt) {
  EXPECT_FALSE(is_of_capture("cap/detections.csv", CaptureDetections::replaced));
  EXPECT_TRUE(is_of_capture("cap/rig.yaml", CaptureDetections::replaced));
  fs::remove(folder_.path() / "cap/detections.csv");
  fs::create_symlink("rig.yaml", folder_.path() / "cap/detections.csv");
  EXPECT_TRUE(is_of_capture("cap/detections.csv", CaptureDetections::replaced));
}

TEST_F(CaptureFiles, LinksInCirclesAndWhatIsNotThereAreNoneOfThem) {
  fs::create_directory_symlink(".", folder_.path() / "cap/cam0/circle");
  fs::create_symlink("loop", folder_.path() / "loop");
  EXPECT_FALSE(is_of_capture("loop"));
  EXPECT_FALSE(is_of_capture("outside/rig.tum"));
  EXPECT_FALSE(is_capture_file(folder_.path() / "a", folder_.path() / "absent"));
}

TEST_F(CaptureFiles, AreSparedInEveryCaptureThatIsRead) {
  const fs::path video = folder_.write("a.mp4", "x");
  const std::vector<fs::path> captures{video, folder_.path() / "cap"};
  for (const char* name : {"a.mp4", "cap/rig.yaml", "cap/cam0/1.jpg"}) {
    const auto spares = check_spares_captures(folder_.path() / name, captures, "another word");
    ASSERT_FALSE(spares) << name;
    EXPECT_EQ(spares.error().kind, ErrorKind::usage);
    EXPECT_NE(spares.error().message.find("another word"), std::string::npos);
  }
  EXPECT_TRUE(check_spares_captures(folder_.path() / "cap/a.map", captures));
}

}  // namespace
}  // namespace waymark
