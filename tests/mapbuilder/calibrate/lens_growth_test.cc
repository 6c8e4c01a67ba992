#include "mapbuilder/calibrate/lens_growth.h"

#include "tests/mapbuilder/calibrate/unknown_room.h"

namespace waymark {
namespace {

/// The room as another lens would have taken it.
test::SyntheticRoom taken_by(test::SyntheticRoom room, const CameraParameters& lens) {
  const CameraModel straight = room.rig.cameras[0].model;
  const CameraModel other = *CameraModel::create(lens);
  for (ImageDetections& image : room.images) {
    std::erase_if(image.detections, [&](Detection& detection) {
      for (Eigen::Vector2d& corner : detection.corners) {
        const auto there = other.project(*straight.bearing(corner));
        if (!there || !other.in_image(*there)) return true;
        corner = *there;
      }
      return false;
    });
  }
  for (RigCamera& camera : room.rig.cameras) camera.model = other;
  return room;
}

std::optional<GrownLens> grown(const test::SyntheticRoom& room,
                               std::optional<Distortion> kind = {}) {
  const std::vector<DetectedCapture> capture{test::capture_of_unknown_rig(room)};
  return grow_lens(captures_of_camera(capture, 0), kind, {});
}

TEST(LensGrowth, AStraightLensStaysStraight) {
  const auto room = test::noisy_room(1);
  const auto lens = grown(room);
  ASSERT_TRUE(lens);
  EXPECT_TRUE(lens->firm);
  EXPECT_EQ(lens->parameters.distortion, Distortion::none) << lens->evidence;
  EXPECT_NEAR(lens->parameters.fu_px, 640, 2);
  EXPECT_NEAR(lens->parameters.pu_px, 639.5, 2);
}

TEST(LensGrowth, ABentLensBends) {
  CameraParameters bent = test::ring_rig(1).cameras[0].model.parameters();
  bent.distortion = Distortion::radtan;
  bent.coefficients = {-0.1, 0.02, 0.0005, -0.0005};
  const auto lens = grown(taken_by(test::noisy_room(1), bent));
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->parameters.distortion, Distortion::radtan) << lens->evidence;
  EXPECT_NEAR(lens->parameters.fu_px, 640, 2);
  EXPECT_NEAR(lens->parameters.coefficients[0], -0.1, 0.01);
}

TEST(LensGrowth, AFisheyeIsOne) {
  CameraParameters fisheye = test::ring_rig(1).cameras[0].model.parameters();
  fisheye.distortion = Distortion::equidistant;
  fisheye.fu_px = fisheye.fv_px = 700;
  fisheye.coefficients = {-0.015, 0.003, 0.0, 0.0};
  const auto lens = grown(taken_by(test::noisy_room(1), fisheye));
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->parameters.distortion, Distortion::equidistant) << lens->evidence;
  EXPECT_NEAR(lens->parameters.fu_px, 700, 3);
}

/// Largest distance of two lenses' images of the directions of one (px), within 90 % of it.
double apart_px(const CameraParameters& one, const CameraParameters& other) {
  const CameraModel a = *CameraModel::create(one);
  const CameraModel b = *CameraModel::create(other);
  double most = 0;
  for (double u = 0.05; u < 1; u += 0.1) {
    for (double v = 0.05; v < 1; v += 0.1) {
      const Eigen::Vector2d pixel(u * one.width_px, v * one.height_px);
      const auto there = b.project(*a.bearing(pixel));
      most = std::max(most, there ? (*there - pixel).norm() : 1e9);
    }
  }
  return most;
}

TEST(LensGrowth, GrowsByK3WhereThatExplains) {
  CameraParameters bent = test::ring_rig(1).cameras[0].model.parameters();
  bent.distortion = Distortion::radtan5;
  bent.coefficients = {-0.26, 0.14, 0.0005, -0.0005, -0.04};
  const auto room = taken_by(test::noisy_room(1), bent);
  for (const std::optional<Distortion> kind : {std::optional<Distortion>(), {Distortion::radtan}}) {
    const auto lens = grown(room, kind);
    ASSERT_TRUE(lens);
    EXPECT_EQ(lens->parameters.distortion, Distortion::radtan5) << lens->evidence;
    EXPECT_LT(apart_px(bent, lens->parameters), 3) << lens->evidence;
  }
}

TEST(LensGrowth, FindsTheKindsThatAreAskedFor) {
  CameraParameters rational = test::ring_rig(1).cameras[0].model.parameters();
  rational.distortion = Distortion::rational;
  rational.coefficients = {0.52, 0.08, 0.0005, -0.0003, 0.004, 0.84, 0.2, 0.018};
  CameraParameters eucm = rational;
  eucm.distortion = Distortion::eucm;
  eucm.fu_px = eucm.fv_px = 760;
  eucm.coefficients = {0.6, 1.1};
  CameraParameters sphere = rational;
  sphere.distortion = Distortion::double_sphere;
  sphere.fu_px = sphere.fv_px = 600;
  sphere.coefficients = {-0.2, 0.58};
  for (const CameraParameters& truth : {rational, eucm, sphere}) {
    const auto lens = grown(taken_by(test::noisy_room(1), truth), truth.distortion);
    ASSERT_TRUE(lens) << to_string(truth.distortion);
    EXPECT_EQ(lens->parameters.distortion, truth.distortion);
    EXPECT_LT(apart_px(truth, lens->parameters), 3) << to_string(truth.distortion);
  }
}

TEST(LensGrowth, TakesTheKindAskedFor) {
  const auto lens = grown(test::noisy_room(1), Distortion::radtan);
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->parameters.distortion, Distortion::radtan);
  EXPECT_NEAR(lens->parameters.fu_px, 640, 2);
}

TEST(LensGrowth, OfImagesOfSingleMarkersIsNone) {
  auto room = test::noisy_room(1);
  for (ImageDetections& image : room.images) {
    if (!image.detections.empty()) image.detections.resize(1);
    for (Detection& detection : image.detections) detection.marker.number = 3;
  }
  const auto lens = grown(room);
  EXPECT_TRUE(!lens || !lens->firm);
}

}  // namespace
}  // namespace waymark
