#include "mapbuilder/diagnosis/explained_build.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "mapbuilder/diagnosis/fit_quality.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

test::SyntheticRoom room(std::uint32_t seed) {
  test::RoomOptions options;
  options.markers = 30;
  options.frame_sets = 30;
  options.noise_px = 0.1;
  options.seed = seed;
  return test::make_room(options);
}

/// Builds the map of a room whose capture was changed.
ExplainedBuild built(const std::function<void(DetectedCapture&)>& change, std::uint32_t seed = 1) {
  std::vector<DetectedCapture> captures{test::capture_of(room(seed))};
  change(captures.front());
  Progress silent(false);
  auto observations = make_observations(captures, {false, 1});
  EXPECT_TRUE(observations);
  BuildOptions options;
  options.threads = 1;
  auto build = build_explained(captures, *std::move(observations), {false, 1}, options, silent);
  EXPECT_TRUE(build);
  return *std::move(build);
}

/// Exactly one cause, and nothing that accuses a marker.
void expect_only(const ExplainedBuild& build, Cause cause) {
  ASSERT_FALSE(build.causes.empty());
  // Of a rig that is its own mirror image another cause may look the same, and says so.
  for (std::size_t i = 1; i < build.causes.size(); ++i) {
    EXPECT_THAT(build.causes[i].text, testing::HasSubstr("look alike"));
  }
  EXPECT_EQ(build.causes[0].cause, cause)
      << name_of(build.causes[0].cause) << ": " << build.causes[0].text;
  EXPECT_EQ(build.causes[0].severity, Severity::error);
  for (const Finding& finding : build.diagnosed.findings) {
    ADD_FAILURE() << finding.subject << " " << finding.text;
  }
  // What is left fits: the map stands as well as one of sound captures.
  EXPECT_LT(build.diagnosed.result.submaps.front().map.rms_all_px, 0.5);
}

TEST(ExplainedBuild, SoundCapturesHaveNoCause) {
  for (const std::uint32_t seed : {1U, 2U}) {
    const ExplainedBuild build = built([](DetectedCapture&) {}, seed);
    EXPECT_THAT(build.causes, testing::IsEmpty());
    EXPECT_THAT(build.diagnosed.findings, testing::IsEmpty());
    const Selection selection(build.observations);
    const FitQuality quality = fit_quality(selection, build.diagnosed.result.estimate);
    EXPECT_NEAR(quality.own_px, 0.1, 0.03);
    EXPECT_NEAR(quality.joint_px, 0.1, 0.03);
    EXPECT_FALSE(quality.contradicts());
  }
}

TEST(ExplainedBuild, AChainWrittenTheOtherWayRoundAccusesNobody) {
  const ExplainedBuild build = built([](DetectedCapture& capture) {
    auto& cameras = capture.rig.cameras;
    std::vector<Rigid3> inverted{cameras[0].rig_from_cam};
    for (std::size_t n = 1; n < cameras.size(); ++n) {
      const Rigid3 link = cameras[n - 1].rig_from_cam.inverse() * cameras[n].rig_from_cam;
      inverted.push_back(inverted.back() * link.inverse());
    }
    for (std::size_t n = 1; n < cameras.size(); ++n) cameras[n].rig_from_cam = inverted[n];
  });
  expect_only(build, Cause::rig_inverted);
}

TEST(ExplainedBuild, SizesAgainstBaselinesAreToldWithTheFactor) {
  for (const double factor : {0.8, 1.25}) {
    const ExplainedBuild build = built([&](DetectedCapture& capture) {
      auto entries = capture.catalog.entries();
      *entries.front().default_size_m *= factor;
      capture.catalog = MarkerCatalog(entries);
    });
    expect_only(build, Cause::size_scale);
    EXPECT_NEAR(build.causes[0].figures[0].value, 100 * (factor - 1), 2);
  }
}

TEST(ExplainedBuild, ALateCameraIsToldWithItsDelay) {
  const ExplainedBuild build = built([](DetectedCapture& capture) {
    // cam1's images are those of one frame set before.
    std::vector<ImageDetections*> of_cam1;
    for (ImageDetections& image : capture.images) {
      if (image.camera == 1) of_cam1.push_back(&image);
    }
    for (std::size_t i = of_cam1.size(); i-- > 1;) {
      of_cam1[i]->detections = of_cam1[i - 1]->detections;
    }
    of_cam1.front()->detections.clear();
  });
  expect_only(build, Cause::clock);
  EXPECT_EQ(build.causes[0].cameras, std::vector<std::string>{"cam1"});
  EXPECT_NEAR(build.causes[0].figures[0].value, 100, 5);
}

TEST(ExplainedBuild, IntrinsicsOfAnotherResolutionAreToldWithTheFactor) {
  const ExplainedBuild build = built([](DetectedCapture& capture) {
    for (RigCamera& camera : capture.rig.cameras) {
      CameraParameters p = camera.model.parameters();
      p.fu_px *= 0.5;
      p.fv_px *= 0.5;
      p.pu_px = (p.pu_px + 0.5) * 0.5 - 0.5;
      p.pv_px = (p.pv_px + 0.5) * 0.5 - 0.5;
      camera.model = *CameraModel::create(p);
    }
  });
  ASSERT_FALSE(build.causes.empty());
  EXPECT_EQ(build.causes[0].cause, Cause::resolution) << build.causes[0].text;
  EXPECT_EQ(build.causes[0].cameras.size(), 3U);
  EXPECT_THAT(build.diagnosed.findings, testing::IsEmpty());
}

}  // namespace
}  // namespace waymark
