#include "mapbuilder/bundle/consider_covariance.h"

#include <gtest/gtest.h>

#include "core/camera/rig_parameters.h"
#include "core/geometry/decompositions.h"
#include "mapbuilder/bundle/bundle_adjustment.h"
#include "tests/mapbuilder/bundle/bundle_of_room.h"

namespace waymark {
namespace {

test::RoomOptions small_room() {
  test::RoomOptions options;
  options.markers = 12;
  options.frame_sets = 24;
  options.room_m = 5;
  return options;
}

/// Of a room at its truth, whose rig is as sure as `edit` says; exact otherwise.
struct ConsideredRoom {
  explicit ConsideredRoom(const std::function<void(test::SyntheticRoom&)>& edit)
      : room(edited(edit)) {}

  [[nodiscard]] ConsideredMap considered(int threads = 1) const {
    BundleProblem problem = test::bundle_of(room);
    problem.constant = {};
    auto map = considered_map(problem, room.truth, threads);
    EXPECT_TRUE(map);
    return *std::move(map);
  }

  static test::SyntheticRoom edited(const std::function<void(test::SyntheticRoom&)>& edit) {
    test::SyntheticRoom made = test::make_room(small_room());
    edit(made);
    return made;
  }

  test::PreparedRoom room;
};

void nothing(test::SyntheticRoom&) {}

void as_kalibr(test::SyntheticRoom& room) {
  for (RigCamera& camera : room.rig.cameras) camera.stated_sigmas = {};
}

TEST(ConsiderCovariance, OfAnExactCalibrationIsThatOfTheNoise) {
  const ConsideredRoom exact(nothing);
  const ConsideredMap map = exact.considered();
  BundleProblem problem = test::bundle_of(exact.room);
  const auto noise = marker_covariances(marker_information(problem, exact.room.truth, 1));
  ASSERT_EQ(map.of_marker.size(), noise.size());
  for (std::size_t i = 0; i < noise.size(); ++i) {
    EXPECT_LT((map.of_marker[i].metric - noise[i]).norm(), 1e-6 * noise[i].norm());
    EXPECT_LT((map.of_marker[i].within - noise[i]).norm(), 1e-6 * noise[i].norm());
  }
  EXPECT_LT(map.parameters.covariance.cwiseAbs().maxCoeff(), 1e-16);
}

TEST(ConsiderCovariance, ModesLeaveEachMarkerAnUncertaintyOfItsOwn) {
  const ConsideredMap map = ConsideredRoom(as_kalibr).considered();
  for (const auto& marker : map.of_marker) {
    const Eigen::Matrix<double, 6, kMapModes> modes = marker.modes.cast<double>();
    const Matrix6d own = marker.metric - modes * modes.transpose();
    EXPECT_GT(symmetric_eigenvalues<6>(own).minCoeff(), -1e-5 * marker.metric.norm());
    EXPECT_LT(own.trace(), 0.9 * marker.metric.trace()) << "they hold what is shared";
  }
  EXPECT_LE(map.dropped_mean, 0.01);
  EXPECT_LE(map.dropped_worst, 0.02);
}

TEST(ConsiderCovariance, NoThreadChangesABit) {
  const ConsideredRoom room(as_kalibr);
  const ConsideredMap one = room.considered(1);
  const ConsideredMap four = room.considered(4);
  for (std::size_t i = 0; i < one.of_marker.size(); ++i) {
    EXPECT_EQ(one.of_marker[i].metric, four.of_marker[i].metric);
    EXPECT_EQ(one.of_marker[i].within, four.of_marker[i].within);
    EXPECT_EQ(one.of_marker[i].modes, four.of_marker[i].modes);
  }
  EXPECT_EQ(one.cross, four.cross);
}

/// All distances' mean by that at truth, less one, after the rig's numbers were changed and the
/// map adjusted.
double scale_after(const std::function<void(Estimate&)>& change) {
  const ConsideredRoom exact(nothing);
  Estimate estimate = exact.room.truth;
  change(estimate);
  PreparedObservations prepared(exact.room.selection, estimate, 1);
  BundleProblem problem = test::bundle_of(exact.room);
  problem.prepared = &prepared;
  BundleOptions options;
  options.function_tolerance = 1e-14;
  const Estimate fitted = adjust(problem, options, estimate).estimate;
  double now = 0;
  double then = 0;
  for (const MarkerIndex a : exact.room.observations.markers.indices()) {
    for (const MarkerIndex b : exact.room.observations.markers.indices()) {
      const auto apart = [&](const Estimate& e) {
        return (e.world_from_marker[a]->translation - e.world_from_marker[b]->translation).norm();
      };
      now += apart(fitted);
      then += apart(exact.room.truth);
    }
  }
  return now / then - 1;
}

/// The scale's sigma where one number of all cameras is known to this alone.
double scale_sigma_of(std::optional<double> StatedSigmas::*number, double sigma) {
  return ConsideredRoom([&](test::SyntheticRoom& room) {
           for (RigCamera& camera : room.rig.cameras) camera.stated_sigmas.*number = sigma;
         })
      .considered()
      .scale.sigma;
}

TEST(ConsiderCovariance, TellsWhatAWrongNumberDoesToTheMap) {
  // One focal length of three cameras, 1 % off; sigmas of all three add in the square.
  double squared = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double scale = scale_after([&](Estimate& estimate) {
      RigCamera& camera = estimate.calibration.rigs.front().cameras[c];
      CameraParameters lens = camera.model.parameters();
      lens.fu_px *= 1.01;
      lens.fv_px *= 1.01;
      camera.model = *CameraModel::create(lens);
    });
    squared += scale * scale;
  }
  EXPECT_NEAR(scale_sigma_of(&StatedSigmas::focal, 0.01) / std::sqrt(squared), 1, 0.05);
}

TEST(ConsiderCovariance, TellsWhatEdgesThatAreSeenFurtherOutDoToTheMap) {
  // All alike: of their variance half is common, and the other half of one camera each.
  const auto by_cameras = [](const std::vector<std::size_t>& cameras) {
    return scale_after([&](Estimate& estimate) {
      for (const std::size_t c : cameras) {
        estimate.calibration.edge_bias_steps_px[CameraIndex(c)] = {-0.3};
      }
    });
  };
  const double common = by_cameras({0, 1, 2});
  EXPECT_LT(common, -1e-4) << "markers look larger, so everything is taken to be nearer";
  double squared = 0.5 * common * common;
  for (const std::size_t c : {0U, 1U, 2U}) squared += 0.5 * std::pow(by_cameras({c}), 2);
  EXPECT_NEAR(scale_sigma_of(&StatedSigmas::edge_px, 0.3) / std::sqrt(squared), 1, 0.05);
}

TEST(ConsiderCovariance, OfARigInItsBodyOnlyWhatMovesCamerasAgainstEachOtherMatters) {
  // All cameras 10 mm off alike would move nothing: a common motion is the rig's.
  const ConsideredRoom room([](test::SyntheticRoom& made) {
    for (RigCamera& camera : made.rig.cameras) camera.stated_sigmas.position_m = 0.01;
    const Rig& rig = made.rig;
    const auto parameters = rig_parameters(rig);
    Eigen::MatrixXd alike = rig_covariance(rig);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      for (std::size_t j = 0; j < parameters.size(); ++j) {
        if (parameters[i].quantity == CameraQuantity::position &&
            parameters[j].quantity == CameraQuantity::position &&
            parameters[i].axis == parameters[j].axis) {
          alike(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = 1e-4;
        }
      }
    }
    made.rig.joint_sigmas = alike;
  });
  const ConsideredMap exact = ConsideredRoom(nothing).considered();
  const ConsideredMap map = room.considered();
  for (std::size_t i = 0; i < map.of_marker.size(); ++i) {
    EXPECT_LT((map.of_marker[i].metric - exact.of_marker[i].metric).norm(),
              1e-3 * exact.of_marker[i].metric.norm());
  }
}

TEST(ConsiderCovariance, MarkersThatNothingTiesAreNotDetermined) {
  const test::PreparedRoom room(test::make_room(small_room()));
  BundleProblem problem = test::bundle_of(room);
  problem.constant = {};
  // One observation per frame set ties nothing.
  std::vector<ObservationIndex> lone;
  for (const ObservationIndex index : room.all()) {
    if (lone.empty() ||
        room.observations[lone.back()].frame_set != room.observations[index].frame_set) {
      lone.push_back(index);
    }
  }
  problem.observations = lone;
  EXPECT_FALSE(considered_map(problem, room.truth, 1));
}

}  // namespace
}  // namespace waymark
