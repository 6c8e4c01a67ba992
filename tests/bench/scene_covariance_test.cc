#include "bench/scene_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>

#include "core/estimate/corner_residual.h"
#include "core/geometry/decompositions.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

/// A room's true geometry, and what its rigs saw, each corner known to `sigma_px`.
struct RoomScene {
  test::SyntheticRoom room;
  SceneGeometry geometry;
};

RoomScene room_scene(int markers, int frame_sets, double sigma_px) {
  RoomScene scene;
  test::RoomOptions options;
  options.markers = markers;
  options.frame_sets = frame_sets;
  scene.room = test::make_room(options);
  SceneGeometry& geometry = scene.geometry;
  geometry.world_from_marker = scene.room.world_from_marker;
  geometry.world_from_rig = scene.room.world_from_rig;
  geometry.sizes_m.assign(geometry.world_from_marker.size(), options.marker_m);
  for (const ImageDetections& image : scene.room.images) {
    for (std::size_t set = 0; set < geometry.world_from_rig.size(); ++set) {
      if (image.stamp != test::room_stamp(static_cast<int>(set))) continue;
      const RigCamera& camera = scene.room.rig.cameras[static_cast<std::size_t>(image.camera)];
      for (const Detection& detection : image.detections) {
        SceneObservation o;
        o.camera = &camera.model;
        o.cam_from_rig = camera.rig_from_cam.inverse();
        o.rig = set;
        o.marker = static_cast<std::size_t>(detection.marker.number);
        o.whitening.fill(Eigen::Matrix2d::Identity() / sigma_px);
        geometry.observations.push_back(o);
      }
    }
  }
  return scene;
}

/// All whitened Jacobians below each other: markers' columns, then rigs'.
Eigen::MatrixXd whole_jacobian(const SceneGeometry& g) {
  const auto poses =
      static_cast<Eigen::Index>(g.world_from_marker.size() + g.world_from_rig.size());
  Eigen::MatrixXd j =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(8 * g.observations.size()), 6 * poses);
  Eigen::Index row = 0;
  for (const SceneObservation& o : g.observations) {
    const CornerChain chain(*o.camera, o.cam_from_rig, g.world_from_rig[o.rig],
                            g.world_from_marker[o.marker]);
    for (std::size_t i = 0; i < 4; ++i, row += 2) {
      CornerJacobians corner;
      EXPECT_TRUE(corner_residual(chain, marker_corners(g.sizes_m[o.marker])[i],
                                  Eigen::Vector2d::Zero(), &corner));
      j.block<2, 6>(row, static_cast<Eigen::Index>(6 * o.marker)) =
          o.whitening[i] * corner.d_marker;
      j.block<2, 6>(row, static_cast<Eigen::Index>(6 * (g.world_from_marker.size() + o.rig))) =
          o.whitening[i] * corner.d_rig;
    }
  }
  return j;
}

/// Errors of markers as an evaluation finds them: after a least-squares motion between positions.
double aligned_rms_m(const std::vector<Rigid3>& truth, const Eigen::VectorXd& displacement) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    pairs.push_back(
        {truth[i].plus(displacement.segment<6>(static_cast<Eigen::Index>(6 * i))), truth[i]});
  }
  return accuracy_of_cameras(pairs)->rmse.translation_m;
}

TEST(SceneCovariance, IsThePseudoInverseAsAnAlignmentShowsIt) {
  const RoomScene scene = room_scene(10, 8, 0.2);
  const auto covariance = SceneCovariance::of(scene.geometry);
  ASSERT_TRUE(covariance.has_value());

  // C = J⁺ J⁺ᵀ, with J⁺ = A⁺ that least squares of least norm applies.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(1e-10);
  decomposition.compute(whole_jacobian(scene.geometry));
  ASSERT_EQ(decomposition.rank(), decomposition.cols() - 6);
  const Eigen::MatrixXd root = decomposition.pseudoInverse();
  // Small enough that the alignment is linear.
  constexpr double kSmall = 1e-4;
  double squares = 0;
  for (Eigen::Index k = 0; k < root.cols(); ++k) {
    const double rms_m =
        aligned_rms_m(scene.geometry.world_from_marker, kSmall * root.col(k).head(60)) / kSmall;
    squares += rms_m * rms_m;
  }
  EXPECT_NEAR(covariance->expected().markers.translation_m, std::sqrt(squares),
              1e-4 * std::sqrt(squares));
}

TEST(SceneCovariance, ScalesWithSigmaAndIsTheSameInEveryWorldFrame) {
  RoomScene scene = room_scene(10, 8, 0.1);
  const SceneRmse fine = SceneCovariance::of(scene.geometry)->expected();
  for (SceneObservation& o : scene.geometry.observations) {
    for (Eigen::Matrix2d& w : o.whitening) w /= 3.0;
  }
  const Rigid3 other_from_world{so3_exp({0.4, -1.1, 0.3}), {12, -7, 3}};
  for (Rigid3& pose : scene.geometry.world_from_marker) pose = other_from_world * pose;
  for (Rigid3& pose : scene.geometry.world_from_rig) pose = other_from_world * pose;
  const SceneRmse coarse = SceneCovariance::of(scene.geometry)->expected();
  EXPECT_NEAR(coarse.markers.translation_m / fine.markers.translation_m, 3.0, 1e-6);
  EXPECT_NEAR(coarse.markers.rotation_rad / fine.markers.rotation_rad, 3.0, 1e-6);
  EXPECT_NEAR(coarse.rigs.translation_m / fine.rigs.translation_m, 3.0, 1e-6);
  EXPECT_NEAR(coarse.rigs_in_map.rotation_rad / fine.rigs_in_map.rotation_rad, 3.0, 1e-6);
}

TEST(SceneCovariance, ExpectationQuantilesAndChiSquareBelongTogether) {
  const RoomScene scene = room_scene(10, 8, 0.1);
  const auto covariance = SceneCovariance::of(scene.geometry);
  const SceneRmse expected = covariance->expected();
  const SceneRmse median = covariance->quantile(0.5, 2000, 1);
  const SceneRmse high = covariance->quantile(0.99, 2000, 1);
  // Few slack motions of the map carry most of its error, so its size varies much.
  EXPECT_GT(median.markers.translation_m, 0.67 * expected.markers.translation_m);
  EXPECT_LT(median.markers.translation_m, expected.markers.translation_m);
  EXPECT_GT(high.markers.translation_m, 1.1 * expected.markers.translation_m);
  EXPECT_LT(high.markers.translation_m,
            2.6 * expected.markers.translation_m);  // |z| of one freedom

  // Errors drawn from the covariance.
  const Eigen::MatrixXd joint = covariance->marker_covariance();
  const SymmetricEigen<Eigen::Dynamic> eigen = symmetric_eigen(joint);
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  double sum = 0;
  constexpr int kDraws = 200;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::VectorXd z =
        Eigen::VectorXd::NullaryExpr(joint.rows(), [&] { return normal(engine); });
    sum += covariance->marker_chi2(eigen.vectors *
                                   (eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal() * z));
  }
  const auto freedom = static_cast<double>(covariance->marker_freedom());
  EXPECT_EQ(freedom, 54);
  EXPECT_NEAR(sum / kDraws, freedom, 4 * std::sqrt(2 * freedom / kDraws));
}

TEST(SceneCovariance, ShiftsThatAMotionOfOneRigExplainsMoveThatRigOnly) {
  const RoomScene scene = room_scene(12, 8, 0.1);
  const SceneGeometry& g = scene.geometry;
  Vector6d step;
  step << 2e-5, -1e-5, 3e-5, 1e-5, 2e-5, -1e-5;
  std::vector<ImageCorners> shifts;
  for (const SceneObservation& o : g.observations) {
    ImageCorners& shift = shifts.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      const auto corner = marker_corners(g.sizes_m[o.marker])[i];
      const auto pixel = [&](const Rigid3& world_from_rig) {
        return *o.camera->project(
            o.cam_from_rig * (world_from_rig.inverse() * (g.world_from_marker[o.marker] * corner)));
      };
      const Rigid3& stood = g.world_from_rig[o.rig];
      shift[i] = o.rig == 3 ? Eigen::Vector2d(pixel(stood.plus(step)) - pixel(stood))
                            : Eigen::Vector2d(Eigen::Vector2d::Zero());
    }
  }
  const SceneRmse moved = SceneCovariance::of(g)->response(shifts);
  EXPECT_LT(moved.markers.translation_m, 1e-8);
  EXPECT_NEAR(moved.rigs_in_map.translation_m, step.head<3>().norm() / std::sqrt(8.0), 1e-8);
  EXPECT_NEAR(moved.rigs_in_map.rotation_rad, step.tail<3>().norm() / std::sqrt(8.0), 1e-8);
}

TEST(SceneCovariance, ScenesThatFallApartHaveNone) {
  RoomScene scene = room_scene(10, 8, 0.1);
  std::erase_if(scene.geometry.observations,
                [](const SceneObservation& o) { return o.marker == 4; });
  EXPECT_FALSE(SceneCovariance::of(scene.geometry).has_value());
}

}  // namespace
}  // namespace waymark
