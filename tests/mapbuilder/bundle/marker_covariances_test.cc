#include "mapbuilder/bundle/marker_covariances.h"

#include <Eigen/Dense>

#include "core/estimate/corner_residual.h"
#include "tests/mapbuilder/bundle/bundle_of_room.h"
#include "tests/mapbuilder/bundle/dense_blocks.h"

namespace waymark {
namespace {

/// Jᵀ J over markers and rigs by the textbook: every corner's row, dense.
Eigen::MatrixXd dense_information(const test::PreparedRoom& room) {
  const auto markers = static_cast<Eigen::Index>(room.observations.markers.size());
  const auto rigs = static_cast<Eigen::Index>(room.observations.frame_sets.size());
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(6 * (markers + rigs), 6 * (markers + rigs));
  for (const ObservationIndex index : room.selection.used()) {
    const Observation& o = room.observations[index];
    const RigCamera& camera = room.truth.calibration.camera(room.observations, o);
    const CornerChain chain(camera.model, camera.rig_from_cam.inverse(),
                            room.truth.world_from_rig[o.frame_set]->best.pose,
                            *room.truth.world_from_marker[o.marker]);
    const auto x = marker_corners(room.prepared[index].size_m);
    const auto marker = static_cast<Eigen::Index>(o.marker.value());
    const auto rig = static_cast<Eigen::Index>(o.frame_set.value());
    for (std::size_t i = 0; i < 4; ++i) {
      CornerJacobians j;
      EXPECT_TRUE(corner_residual(chain, x[i], o.corners_px[i], &j));
      Eigen::MatrixXd row = Eigen::MatrixXd::Zero(2, h.cols());
      row.middleCols<6>(6 * marker) = room.prepared[index].whitening[i] * j.d_marker;
      row.middleCols<6>(6 * (markers + rig)) = room.prepared[index].whitening[i] * j.d_rig;
      h += row.transpose() * row;
    }
  }
  return h;
}

test::RoomOptions small_room() {
  test::RoomOptions options;
  options.markers = 8;
  options.frame_sets = 12;
  options.room_m = 5;
  return options;
}

class SmallRoom : public testing::Test {
 protected:
  [[nodiscard]] MarkerInformation information(std::vector<ObservationIndex> observations) const {
    BundleProblem problem = test::bundle_of(room);
    problem.loss = {};
    problem.observations = std::move(observations);
    return marker_information(problem, room.truth, 1);
  }
  test::PreparedRoom room{test::make_room(small_room())};
  Eigen::Index rows = static_cast<Eigen::Index>(6 * room.observations.markers.size());
};

TEST_F(SmallRoom, TheReducedSystemIsTheSchurComplement) {
  const auto system = information(room.all());
  ASSERT_EQ(system.markers.size(), room.observations.markers.size());
  const Eigen::MatrixXd h = dense_information(room);
  const Eigen::Index n = rows;
  const Eigen::MatrixXd rr = h.bottomRightCorner(h.rows() - n, h.cols() - n);
  const Eigen::MatrixXd schur =
      h.topLeftCorner(n, n) -
      h.topRightCorner(n, h.cols() - n) * rr.ldlt().solve(h.bottomLeftCorner(h.rows() - n, n));
  EXPECT_LT((test::dense(system.information) - schur).norm(), 1e-9 * schur.norm());
}

TEST_F(SmallRoom, CovariancesAreThoseOfTheGaugeWithoutMeanMotion) {
  const auto system = information(room.all());
  const auto covariances = marker_covariances(system);
  const auto& poses = room.truth.world_from_marker.values();
  ASSERT_EQ(covariances.size(), poses.size());

  // The same by a dense constrained inverse: minimize with Gᵀx = 0.
  const Eigen::Index n = rows;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& marker : poses) {
    centre += marker->translation / static_cast<double>(poses.size());
  }
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(n, 6);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    g.block<3, 3>(row, 0).setIdentity();
    g.block<3, 3>(row, 3) = -skew(poses[i]->translation - centre);
  }
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 6, n + 6);
  bordered.topLeftCorner(n, n) = test::dense(system.information);
  bordered.topRightCorner(n, 6) = g;
  bordered.bottomLeftCorner(6, n) = g.transpose();
  const Eigen::MatrixXd inverse = bordered.fullPivLu().inverse();
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Matrix6d expected = inverse.block<6, 6>(row, row);
    EXPECT_LT((covariances[i] - expected).norm(), 1e-6 * expected.norm());
  }
}

TEST_F(SmallRoom, OneMarkerAloneHasNoCovariance) {
  const auto of_one = room.selection.used_of(MarkerIndex(0));
  const auto system = information({of_one.begin(), of_one.end()});
  EXPECT_EQ(system.markers.size(), 1U);
  EXPECT_TRUE(marker_covariances(system).empty());
}

}  // namespace
}  // namespace waymark
