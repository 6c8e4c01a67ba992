#include "core/estimate/consider_parameters.h"

#include <gtest/gtest.h>

#include "core/base/check.h"

namespace waymark {
namespace {

Rig rig_of(std::size_t cameras) {
  CameraParameters p;
  p.width_px = 640;
  p.height_px = 480;
  p.fu_px = 500;
  p.fv_px = 510;
  p.pu_px = 320;
  p.pv_px = 240;
  p.distortion = Distortion::radtan;
  const auto model = CameraModel::create(p);
  WAYMARK_CHECK(model);
  Rig rig;
  for (std::size_t i = 0; i < cameras; ++i) {
    RigCamera camera{"cam" + std::to_string(i), *model, {}, "", "", {}, {}, {}};
    camera.rig_from_cam.translation.x() = 0.1 * static_cast<double>(i);
    rig.cameras.push_back(camera);
  }
  return rig;
}

TEST(ConsiderParameters, RigsThenSizes) {
  const std::vector<Rig> rigs{rig_of(2), rig_of(1)};
  const std::vector<StatedSize> sizes{{0.16, 0.00125}, {0.3, 0.001}};
  const ConsiderParameters made = consider_parameters(rigs, sizes);
  ASSERT_EQ(made.all.size(), 7U + 13U + 7U + 2U);
  ASSERT_EQ(made.count(), 29);
  EXPECT_EQ(name_of(made.all.front(), rigs), "cam0 focal length");
  EXPECT_EQ(name_of(made.all[8], rigs), "cam1 position y");
  EXPECT_EQ(name_of(made.all[20], rigs), "rig1 cam0 focal length");
  EXPECT_EQ(name_of(made.all[21], rigs), "rig1 cam0 principal point u");
  EXPECT_EQ(name_of(made.all[27], rigs), "size 0.16 m");
  EXPECT_DOUBLE_EQ(made.covariance(27, 27), 0.00125 * 0.00125);
  EXPECT_DOUBLE_EQ(made.covariance(28, 27), 0.5 * 0.00125 * 0.001);
  EXPECT_EQ(made.covariance(27, 0), 0);
}

TEST(ConsiderParameters, EdgesOfAllRigsHaveHalfTheirVarianceInCommon) {
  const std::vector<Rig> rigs{rig_of(2), rig_of(1)};
  const ConsiderParameters made = consider_parameters(rigs, {});
  for (Eigen::Index i = 0; i < made.count(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const auto quantity = [&](Eigen::Index k) {
        return made.all[static_cast<std::size_t>(k)].of_rig.quantity;
      };
      const bool edges = quantity(i) == CameraQuantity::edge && quantity(j) == CameraQuantity::edge;
      EXPECT_DOUBLE_EQ(made.covariance(i, j), edges ? 0.5 * 0.04 : 0.0);
    }
  }
}

TEST(ConsiderParameters, TangentsMoveWhatTheyName) {
  const std::vector<Rig> rigs{rig_of(2)};
  const CameraModel& model = rigs[0].cameras[0].model;
  const auto tangent = [&](CameraQuantity quantity, int axis) {
    return tangent_of({0, {1, quantity, axis}, 0}, model);
  };
  EXPECT_EQ(tangent(CameraQuantity::position, 2)[2], 1);
  EXPECT_EQ(tangent(CameraQuantity::rotation, 2)[5], 1);
  EXPECT_EQ(tangent(CameraQuantity::focal, 0)[6], 500);
  EXPECT_EQ(tangent(CameraQuantity::focal, 0)[7], 510);
  EXPECT_EQ(tangent(CameraQuantity::principal, 1)[9], 1);
  EXPECT_EQ(tangent(CameraQuantity::k1, 0)[10], 1);
  EXPECT_EQ(tangent(CameraQuantity::edge, 0)[18], 1);
  EXPECT_TRUE(tangent(CameraQuantity::stamp, 0).isZero(0));
  EXPECT_EQ(tangent_of({0, {}, 0.16}, model)[19], 1);
}

TEST(ConsiderParameters, RootsSquareToTheCovariance) {
  Eigen::MatrixXd covariance(3, 3);
  covariance << 4e-6, 1e-3, 0, 1e-3, 2, 0, 0, 0, 0;
  const Eigen::MatrixXd root = square_root_of(covariance);
  EXPECT_TRUE((root * root.transpose()).isApprox(covariance, 1e-12));
}

}  // namespace
}  // namespace waymark
