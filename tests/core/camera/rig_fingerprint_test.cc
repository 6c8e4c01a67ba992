#include "core/camera/rig_fingerprint.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"
#include "core/geometry/so3.h"

namespace waymark {
namespace {

Rig rig() {
  CameraParameters p;
  p.width_px = 640;
  p.height_px = 480;
  p.fu_px = p.fv_px = 500;
  p.pu_px = 319.5;
  p.pv_px = 239.5;
  Rig rig;
  rig.cameras.push_back({"cam0", *CameraModel::create(p), {}, {}, {}, {}, {}, {}});
  return rig;
}

TEST(RigFingerprint, DependsOnNumbersAlone) {
  Rig other = stated_exact(rig());
  other.cameras[0].serial = "42";
  EXPECT_EQ(fingerprint(other), fingerprint(rig()));
  other.cameras[0].rig_from_cam.translation.x() += 1e-8;
  EXPECT_NE(fingerprint(other), fingerprint(rig()));
}

TEST(RigFingerprint, DependsOnEveryNumberOfALens) {
  Rig rational = rig();
  CameraParameters p = rational.cameras[0].model.parameters();
  p.distortion = Distortion::rational;
  rational.cameras[0].model = *CameraModel::create(p);
  Rig other = rational;
  p.coefficients[7] = 1e-12;
  other.cameras[0].model = *CameraModel::create(p);
  EXPECT_NE(fingerprint(other), fingerprint(rational));
  p.valid_radius_px = 300;
  other.cameras[0].model = *CameraModel::create(p);
  const std::string bounded = fingerprint(other);
  p.valid_radius_px = 301;
  other.cameras[0].model = *CameraModel::create(p);
  EXPECT_NE(fingerprint(other), bounded);
}

// Chained and inverted transforms come back with other last bits, again and again.
TEST(RigFingerprint, IsThatOfTheFileReadAgain) {
  for (int cameras = 1; cameras <= 6; ++cameras) {
    for (const bool in_body : {false, true}) {
      Rig written = rig();
      for (int k = 1; k < cameras; ++k) {
        const double turn = 2.0 * std::numbers::pi * k / cameras;
        RigCamera& camera = written.cameras.emplace_back(written.cameras[0]);
        camera.name = fmt::format("cam{}", k);
        camera.rig_from_cam = {so3_exp({0.1 * k, turn, 0.03}),
                               {0.1 * std::sin(turn), 0.07, k / 3.0}};
      }
      const Rigid3 body_from_cam0{so3_exp({0.3, -1.2, 2.1}), {0.4, 1 / 3.0, -0.7}};
      if (in_body) {
        for (RigCamera& camera : written.cameras) {
          camera.rig_from_cam = body_from_cam0 * camera.rig_from_cam;
        }
      }
      Rig read = written;
      for (int round = 0; round < 3; ++round) {
        const auto again = parse_camchain(format_camchain(read), "rig.yaml");
        ASSERT_TRUE(again.has_value());
        read = again->rig;
        EXPECT_EQ(fingerprint(read), fingerprint(written)) << cameras << " cameras, " << round;
      }
    }
  }
}

}  // namespace
}  // namespace waymark
