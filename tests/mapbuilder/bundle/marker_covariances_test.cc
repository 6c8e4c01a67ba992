#include "mapbuilder/bundle/marker_covariances.h"

#include <Eigen/Dense>

#include "core/estimate/corner_residual.h"
#include "tests/mapbuilder/bundle/dense_blocks.h"
#include "tests/mapbuilder/observations/room_table.h"

namespace waymark {
namespace {

/// Jᵀ J over markers and rigs by the textbook: every corner's row, dense.
Eigen::MatrixXd dense_information(const ObservationTable& table, const MapState& state) {
  const auto markers = static_cast<Eigen::Index>(table.markers.size());
  const auto rigs = static_cast<Eigen::Index>(table.frame_sets.size());
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(6 * (markers + rigs), 6 * (markers + rigs));
  for (const TableObservation& o : table.observations) {
    const RigCamera& camera = camera_of(table, o);
    const CornerChain chain(camera.model, camera.rig_from_cam.inverse(),
                            state.rigs[static_cast<std::size_t>(o.frame_set)]->best.pose,
                            *state.world_from_marker[static_cast<std::size_t>(o.marker)]);
    const auto x = marker_corners(o.size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      CornerJacobians j;
      EXPECT_TRUE(corner_residual(chain, x[i], o.corners_px[i], &j));
      Eigen::MatrixXd row = Eigen::MatrixXd::Zero(2, h.cols());
      row.middleCols<6>(6 * o.marker) = o.whitening[i] * j.d_marker;
      row.middleCols<6>(6 * (markers + o.frame_set)) = o.whitening[i] * j.d_rig;
      h += row.transpose() * row;
    }
  }
  return h;
}

class SmallRoom : public testing::Test {
 protected:
  SmallRoom() {
    test::RoomOptions options;
    options.markers = 8;
    options.frame_sets = 12;
    options.room_m = 5;
    room = test::make_room(options);
    table = test::table_of(room);
  }
  test::SyntheticRoom room;
  ObservationTable table;
};

TEST_F(SmallRoom, TheReducedSystemIsTheSchurComplement) {
  const MapState state = test::true_state(room, table);
  const auto system = marker_information(table, test::all_observations(table), {}, {}, 1, state);
  ASSERT_EQ(system.markers.size(), table.markers.size());
  const Eigen::MatrixXd h = dense_information(table, state);
  const auto n = static_cast<Eigen::Index>(6 * table.markers.size());
  const Eigen::MatrixXd rr = h.bottomRightCorner(h.rows() - n, h.cols() - n);
  const Eigen::MatrixXd schur =
      h.topLeftCorner(n, n) -
      h.topRightCorner(n, h.cols() - n) * rr.ldlt().solve(h.bottomLeftCorner(h.rows() - n, n));
  EXPECT_LT((test::dense(system.information) - schur).norm(), 1e-9 * schur.norm());
}

TEST_F(SmallRoom, CovariancesAreThoseOfTheGaugeWithoutMeanMotion) {
  const MapState state = test::true_state(room, table);
  const auto system = marker_information(table, test::all_observations(table), {}, {}, 1, state);
  const auto covariances = marker_covariances(system);
  ASSERT_EQ(covariances.size(), table.markers.size());

  // The same by a dense constrained inverse: minimize with Gᵀx = 0.
  const auto n = static_cast<Eigen::Index>(6 * table.markers.size());
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& marker : state.world_from_marker) {
    centre += marker->translation / static_cast<double>(table.markers.size());
  }
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(n, 6);
  for (std::size_t i = 0; i < table.markers.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    g.block<3, 3>(row, 0).setIdentity();
    g.block<3, 3>(row, 3) = -skew(state.world_from_marker[i]->translation - centre);
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
  const MapState state = test::true_state(room, table);
  const auto system = marker_information(table, table.observations_of_marker[0], {}, {}, 1, state);
  EXPECT_EQ(system.markers.size(), 1U);
  EXPECT_TRUE(marker_covariances(system).empty());
}

}  // namespace
}  // namespace waymark
