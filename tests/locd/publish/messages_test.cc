#include "locd/publish/messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <numbers>

namespace waymark {
namespace {

SessionFacts session() {
  return {"0123456789abcdef", "fedcba9876543210", {}, true, 3, "00112233aabbccdd"};
}

/// The machine came up at the epoch + 1,800,000,000 s, so that offsets are round numbers.
ClockOffset clock_offset() {
  return ClockOffset({Stamp{0}, Stamp{0}, std::chrono::seconds(1'800'000'000)});
}

PoseEstimate estimate() {
  PoseEstimate e;
  e.stamp = std::chrono::milliseconds(5000);
  e.status = PoseStatus::degraded;
  e.reasons = bit(PoseReason::camera_missing) | bit(PoseReason::sigma);
  e.world_from_rig = {Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())),
                      Eigen::Vector3d(1, 2, 3)};
  e.covariance = Matrix6d::Identity() * 1e-6;
  e.covariance(0, 5) = e.covariance(5, 0) = 3e-7;
  e.resets = 2;
  e.cameras_in_set = 0b101;
  e.cameras_used = 0b001;
  e.markers_used = 4;
  e.outliers = 2;
  e.rms_px = 0.25;
  e.max_skew = std::chrono::microseconds(120);
  e.camera_offset[0] = std::chrono::microseconds(-60);
  e.camera_offset[2] = std::chrono::microseconds(60);
  return e;
}

TEST(Messages, APoseIsSaidAsItWasEstimated) {
  const SessionFacts facts = session();
  pose_t m = make_pose_message(facts);
  fill_pose(estimate(), facts, clock_offset(), std::chrono::milliseconds(5040), m);
  EXPECT_EQ(m.utime, 1'800'000'005'000'000);
  EXPECT_EQ(m.utime_published, 1'800'000'005'040'000);
  EXPECT_DOUBLE_EQ(m.latency_ms, 40);
  EXPECT_EQ(m.session_id, "0123456789abcdef");
  EXPECT_EQ(m.map_hash, "fedcba9876543210");
  EXPECT_EQ(m.status, pose_t::DEGRADED);
  EXPECT_EQ(m.reasons, int{pose_t::CAMERA_MISSING} | int{pose_t::SIGMA});
  EXPECT_NEAR(m.sigma_m, 1e-3, 1e-4);
  EXPECT_EQ(m.status_text.rfind("DEGRADED: ", 0), 0U);
  EXPECT_EQ(m.resets, 2);
  EXPECT_EQ(m.cameras, 3);
  EXPECT_EQ(m.cameras_used, 1);
  EXPECT_EQ(m.markers_used, 4);
  EXPECT_EQ(m.outliers, 2);
  EXPECT_DOUBLE_EQ(m.rms_px, 0.25);
  EXPECT_DOUBLE_EQ(m.max_skew_us, 120);
  ASSERT_EQ(m.camera_offset_us.size(), 3U);
  EXPECT_DOUBLE_EQ(m.camera_offset_us[0], -60);
  EXPECT_TRUE(std::isnan(m.camera_offset_us[1]));
  EXPECT_DOUBLE_EQ(m.camera_offset_us[2], 60);
  EXPECT_DOUBLE_EQ(m.x_m, 1);
  EXPECT_DOUBLE_EQ(m.position[1], 2);
  EXPECT_DOUBLE_EQ(m.z_m, 3);
  EXPECT_NEAR(m.quaternion[0], std::cos(0.25), 1e-15);  // w first
  EXPECT_NEAR(m.quaternion[3], std::sin(0.25), 1e-15);
  EXPECT_NEAR(m.yaw_deg, 0.5 * 180 / std::numbers::pi, 1e-12);
  EXPECT_DOUBLE_EQ(m.covariance[0], 1e-6);
  EXPECT_DOUBLE_EQ(m.covariance[5], 3e-7);
}

TEST(Messages, LostMeansNothingButNaN) {
  const SessionFacts facts = session();
  pose_t m = make_pose_message(facts);
  PoseEstimate lost = estimate();
  fill_pose(lost, facts, clock_offset(), lost.stamp, m);
  lost.lose_pose(PoseReason::no_markers);
  fill_pose(lost, facts, clock_offset(), lost.stamp, m);
  EXPECT_EQ(m.status, pose_t::LOST);
  EXPECT_EQ(m.reasons, pose_t::NO_MARKERS);
  for (const double v : m.position) EXPECT_TRUE(std::isnan(v));
  for (const double v : m.quaternion) EXPECT_TRUE(std::isnan(v));
  for (const double v : m.covariance) EXPECT_TRUE(std::isnan(v));
  for (const double v : {m.x_m, m.y_m, m.z_m, m.yaw_deg, m.rms_px, m.sigma_m, m.sigma_deg})
    EXPECT_TRUE(std::isnan(v));
}

TEST(Messages, YawHasNoMeaningWhereUpIsNotKnown) {
  SessionFacts facts = session();
  facts.world_z_is_up = false;
  pose_t m = make_pose_message(facts);
  fill_pose(estimate(), facts, clock_offset(), Stamp{0}, m);
  EXPECT_TRUE(std::isnan(m.yaw_deg));
  EXPECT_DOUBLE_EQ(m.x_m, 1);
}

TEST(Messages, ARotationHasOneQuaternion) {
  PoseEstimate e = estimate();
  pose_t plus = make_pose_message(session());
  fill_pose(e, session(), clock_offset(), Stamp{0}, plus);
  e.world_from_rig.rotation.coeffs() *= -1;
  pose_t minus = make_pose_message(session());
  fill_pose(e, session(), clock_offset(), Stamp{0}, minus);
  EXPECT_GT(plus.quaternion[0], 0);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(plus.quaternion[i], minus.quaternion[i]);
}

TEST(Messages, ThePoseIsThatOfTheVehiclesBase) {
  SessionFacts facts = session();
  facts.base_from_rig = {Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2) / 3)),
                         Eigen::Vector3d(0.4, -0.1, 1.2)};
  const PoseEstimate e = estimate();
  pose_t m = make_pose_message(facts);
  fill_pose(e, facts, clock_offset(), Stamp{0}, m);
  const Rigid3 world_from_base{
      Eigen::Quaterniond(m.quaternion[0], m.quaternion[1], m.quaternion[2], m.quaternion[3]),
      Eigen::Vector3d(m.position[0], m.position[1], m.position[2])};
  EXPECT_LT((world_from_base * facts.base_from_rig).minus(e.world_from_rig).norm(), 1e-12);
}

TEST(Messages, TheBasesCovarianceIsThatOfItsMotion) {
  const Rigid3 base_from_rig{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2) / 3)),
      Eigen::Vector3d(0.4, -0.1, 1.2)};
  const PoseEstimate e = estimate();
  Matrix6d numeric;
  const Rigid3 at = e.world_from_rig * base_from_rig.inverse();
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = Vector6d::Unit(i) * 1e-6;
    numeric.col(i) = (e.world_from_rig.plus(step) * base_from_rig.inverse()).minus(at) / 1e-6;
  }
  const Matrix6d expected = numeric * e.covariance * numeric.transpose();
  const Matrix6d found = covariance_of_base(e.world_from_rig, e.covariance, base_from_rig);
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(Messages, YawIsInTheHalfOpenCircle) {
  const auto yaw = [](double angle) {
    return yaw_deg({Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
                    Eigen::Vector3d::Zero()});
  };
  EXPECT_DOUBLE_EQ(yaw(0), 0);
  EXPECT_NEAR(yaw(std::numbers::pi / 2), 90, 1e-12);
  EXPECT_NEAR(yaw(-std::numbers::pi / 2), -90, 1e-12);
  EXPECT_NEAR(std::abs(yaw(std::numbers::pi)), 180, 1e-12);
  EXPECT_GT(yaw(-std::numbers::pi), -180);
}

TEST(Messages, DetectionsSurviveEncoding) {
  const SessionFacts facts = session();
  PoseEstimate e = estimate();
  for (int i = 0; i < 3; ++i) {
    ObservedMarker seen;
    seen.marker = {Family::tag36h11, 10 + i};
    seen.camera = static_cast<std::int16_t>(i);
    seen.verdict = ObservationVerdict::outlier;
    for (std::size_t k = 0; k < 4; ++k) {
      seen.corners_px[k] = Eigen::Vector2d(100.5 * i + static_cast<double>(k), 7.25);
    }
    if (i == 2) {
      seen.covariances.emplace().fill((Eigen::Matrix2d() << 0.25, 0.125, 0.125, 0.5).finished());
    }
    e.observations.push_back(seen);
  }
  detections_t m = make_detections_message(facts);
  fill_detections(e, facts, clock_offset(), m);
  lcm::LCM lcm("memq://");
  detections_t back;
  const auto keep = [](const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                       const detections_t* received, detections_t* kept) { *kept = *received; };
  lcm.subscribeFunction<detections_t, detections_t*>("D", +keep, &back);
  ASSERT_EQ(lcm.publish("D", &m), 0);
  ASSERT_EQ(lcm.handleTimeout(1000), 1);
  ASSERT_EQ(back.count, 3);
  EXPECT_EQ(back.family[2], "tag36h11");
  EXPECT_EQ(back.marker_id[2], 12);
  EXPECT_EQ(back.camera[1], 1);
  EXPECT_EQ(back.verdict[0], 1);
  EXPECT_EQ(back.rig, facts.rig);
  ASSERT_EQ(back.camera_count, 3);
  EXPECT_EQ(std::isnan(back.camera_offset_us[0]), (e.cameras_in_set & camera_bit(0)) == 0);
  EXPECT_TRUE(std::isnan(back.covariances_px2[0][0])) << "none was stated";
  const std::vector<float> stated{0.25F, 0.125F, 0.5F, 0.25F, 0.125F, 0.5F,
                                  0.25F, 0.125F, 0.5F, 0.25F, 0.125F, 0.5F};
  EXPECT_EQ(back.covariances_px2[2], stated);
  EXPECT_FLOAT_EQ(back.corners_px[2][4], 203.0F);
  EXPECT_FLOAT_EQ(back.corners_px[2][5], 7.25F);
}

TEST(Messages, AnAlertNamesWhomItConcerns) {
  Rig rig;
  rig.cameras.resize(2, RigCamera{"cam0", *CameraModel::create({}), {}, {}, {}, {}, {}, {}});
  rig.cameras[1].name = "cam1";
  alert_t m;
  Alert alert;
  alert.kind = AlertKind::image_dark;
  alert.camera = 1;
  alert.stamp = std::chrono::seconds(2);
  const MapIdentity one_family{"aa", false, false};
  fill_alert(alert, rig, one_family, session(), clock_offset(), m);
  EXPECT_EQ(m.kind, "DARK");
  EXPECT_EQ(m.subject, "cam1");
  EXPECT_EQ(m.utime, 1'800'000'002'000'000);
  EXPECT_NE(m.text.find("cam1"), std::string::npos);
  EXPECT_TRUE(std::isnan(m.offset_m));
  alert = {};
  alert.marker = MarkerId{Family::tag36h11, 7};
  alert.offset_m = 0.31;
  const MapIdentity families{"bb", false, true};
  fill_alert(alert, rig, families, session(), clock_offset(), m);
  EXPECT_EQ(m.map_hash, "bb");
  EXPECT_EQ(m.kind, "MOVED");
  EXPECT_EQ(m.subject, "tag36h11:7");
  EXPECT_DOUBLE_EQ(m.offset_m, 0.31);
}

TEST(Messages, SessionsHaveNamesOfTheirOwn) {
  const std::string first = new_session_id();
  EXPECT_EQ(first.size(), 16U);
  EXPECT_EQ(first.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(first, new_session_id());
}

}  // namespace
}  // namespace waymark
