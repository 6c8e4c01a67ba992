#include "simulator/render_capture.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>

#include "core/base/atomic_file.h"
#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "core/detect/image_detector.h"
#include "core/geometry/tum.h"
#include "simulator/scene_library.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace waymark::simulator {
namespace {

namespace fs = std::filesystem;

class RenderCapture : public testing::Test {
 protected:
  static RenderJob quick_job() {
    RenderJob job;
    job.positions = 1;
    job.show_progress = false;
    return job;
  }
  fs::path render(const std::string& folder, const std::string& rig, const RenderJob& job) {
    const auto loaded = load_rig(rig);
    EXPECT_TRUE(loaded.has_value());
    const auto result = render_capture(*scene_, *loaded, job, temporary_.path() / folder, stop_);
    EXPECT_TRUE(result.has_value()) << result.error().message;
    return temporary_.path() / folder;
  }

  TemporaryFolder temporary_;
  std::atomic<bool> stop_{false};
  Expected<Scene> scene_ = load_scene("room1");
};

TEST_F(RenderCapture, ImagesDependOnTheSeedAndNotOnThreads) {
  RenderJob job = quick_job();
  job.threads = 1;
  const fs::path one = render("one", "cg180", job);
  job.threads = 3;
  const fs::path three = render("three", "cg180", job);
  job.seed = 2;
  const fs::path other = render("other", "cg180", job);
  const fs::path image = fs::path("cam1") / "1700000000000000000.jpg";
  EXPECT_EQ(*read_file(one / image), *read_file(three / image));
  EXPECT_NE(*read_file(one / image), *read_file(other / image));
}

TEST_F(RenderCapture, MonoTellsNoTransformsAndGivesEachCamerasTruth) {
  const fs::path folder = render("mono", "mono", quick_job());
  const auto capture = open_capture_folder(folder);
  ASSERT_TRUE(capture.has_value()) << capture.error().message;
  EXPECT_FALSE(capture->rig.has_extrinsics);
  EXPECT_EQ(capture->images.size(), 3U);
  const auto image = read_gray_image(capture->images.front().path);
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->image.width_px, 1224);
  EXPECT_EQ(image->image.height_px, 1024);
  for (const char* name : {"rig.tum", "rig.cam0.tum", "rig.cam1.tum", "rig.cam2.tum"}) {
    const auto truth = read_tum(folder / "groundtruth" / name);
    ASSERT_TRUE(truth.has_value()) << name;
    EXPECT_EQ(truth->size(), 1U);
  }
}

TEST_F(RenderCapture, DrivingShiftsStampsWithinTheSyncToleranceAndBlurs) {
  RenderJob job = quick_job();
  job.settings = drive_level();
  job.settings.sub_exposures = 2;
  const fs::path folder = render("drive", "cg180", job);
  const auto capture = open_capture_folder(folder);
  ASSERT_TRUE(capture.has_value()) << capture.error().message;
  ASSERT_EQ(capture->images.size(), 2U);
  const auto skew = capture->images[1].stamp - capture->images[0].stamp;
  EXPECT_GT(skew.count(), 0);
  EXPECT_LT(skew, kDefaultSyncTolerance);
  const auto truth = read_tum(folder / "groundtruth" / "rig.tum");
  ASSERT_TRUE(truth.has_value());
  const Stamp cam0 = capture->images[capture->images[0].camera == 0 ? 0 : 1].stamp;
  EXPECT_EQ(truth->front().key, format_stamp_s(cam0));
}

TEST_F(RenderCapture, InterruptionAndExistingOutputLeaveEverythingAsItWas) {
  const auto rig = load_rig("cg180");
  stop_ = true;
  auto result = render_capture(*scene_, *rig, quick_job(), temporary_.path() / "x", stop_);
  EXPECT_FALSE(result.has_value());
  EXPECT_TRUE(fs::is_empty(temporary_.path()));
  stop_ = false;
  fs::create_directory(temporary_.path() / "full");
  std::ofstream(temporary_.path() / "full" / "mine.txt") << "mine";
  result = render_capture(*scene_, *rig, quick_job(), temporary_.path() / "full", stop_);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, ErrorKind::cant_create);
  EXPECT_EQ(*read_file(temporary_.path() / "full" / "mine.txt"), "mine");
}

TEST_F(RenderCapture, AFullDiskLeavesNothingBehind) {
  const auto rig = load_rig("cg180");
  Expected<RenderResult> result = tl::make_unexpected(Error{ErrorKind::internal, ""});
  {
    const test::FullDisk full(20'000);  // enough for the description, not for an image
    result = render_capture(*scene_, *rig, quick_job(), temporary_.path() / "x", stop_);
  }
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, ErrorKind::io) << result.error().message;
  EXPECT_NE(result.error().message.find(".jpg"), std::string::npos) << result.error().message;
  EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
  EXPECT_TRUE(fs::is_empty(temporary_.path()));
}

TEST_F(RenderCapture, MarkersOfWhiteSquaresInBlackAreThereToo) {
  scene_ = load_scene("aisles2");
  RenderJob job = quick_job();
  job.positions = 4;  // where the way begins there are none
  const auto capture = open_capture_folder(render("aisles2", "cg180", job));
  ASSERT_TRUE(capture.has_value()) << capture.error().message;
  ImageDetector detector(capture->catalog);
  std::size_t seen = 0;
  for (const auto& image : capture->images) {
    const auto loaded = read_gray_image(image.path);
    ASSERT_TRUE(loaded.has_value());
    const CameraModel& camera = capture->rig.cameras[image.camera].model;
    seen += detector.detect(loaded->image.view(), camera).detections.size();
  }
  EXPECT_GT(seen, 2U);
}

}  // namespace
}  // namespace waymark::simulator
