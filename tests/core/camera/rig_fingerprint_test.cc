#include "core/camera/rig_fingerprint.h"

#include <gtest/gtest.h>

#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"

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
  other.cameras[0].rig_from_cam.translation.x() += 1e-12;
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

TEST(RigFingerprint, IsThatOfTheFileReadAgain) {
  const auto again = parse_camchain(format_camchain(rig()), "rig.yaml");
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(fingerprint(again->rig), fingerprint(rig()));
}

}  // namespace
}  // namespace waymark
