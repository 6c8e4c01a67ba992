#include "locd/pose/corner_noise.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/estimate/ippe.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

constexpr double kStartStated_px = 0.06;
constexpr double kStartUnstated_px = 0.5;
/// Markers that tell something.
constexpr std::size_t kFewest = 6;
/// χ² of 2 freedoms at 99 %, and the mean of what lies below: inliers and their mean.
constexpr double kInlier = 9.21;
constexpr double kMeanOfInliers = 1.907;
constexpr int kRounds = 5;
/// A usual noise is learnt over so many updates.
constexpr double kUsualUpdates = 1000;
constexpr int kUsualFrom = 50;
/// Ten times is told, with what the estimates scatter.
constexpr double kUnusual = 7.0;
constexpr double kUsualAgain = 4.0;
/// So many newest markers tell that noise is another than before: their median is off by four or
/// more of its own sigmas; and so many that what is assumed for a set is far too little.
constexpr std::size_t kNewest = 64;
constexpr double kMore = 1.8;
constexpr double kLess = 0.45;
constexpr std::size_t kLatest = 16;
constexpr double kTooLittle = 2.5;

}  // namespace

CornerNoise::CornerNoise() {
  memory_.reserve(kMemory);
  ratios_.reserve(kMemory);
}

void CornerNoise::begin(bool stated) { sigma_px_ = stated ? kStartStated_px : kStartUnstated_px; }

void CornerNoise::add(const Left& left) {
  if (memory_.size() == kMemory) memory_.erase(memory_.begin());
  memory_.push_back(left);
}

double CornerNoise::ratio_of_newest(std::size_t count) {
  ratios_.clear();
  for (std::size_t i = memory_.size() - std::min(count, memory_.size()); i < memory_.size(); ++i) {
    ratios_.push_back(memory_[i].squared_px2 /
                      std::max(memory_[i].stated_px2 + sigma_px_ * sigma_px_, 1e-12));
  }
  return median(ratios_) / kMedianOfChi2_2;
}

void CornerNoise::keep_newest(std::size_t count) {
  memory_.erase(memory_.begin(), memory_.end() - static_cast<std::ptrdiff_t>(count));
}

void CornerNoise::update() {
  if (memory_.size() < kFewest) return;
  if (memory_.size() > kNewest) {
    const double ratio = ratio_of_newest(kNewest);
    if (ratio > kMore || ratio < kLess) keep_newest(kNewest);
  }
  // Of what was added to the detector's variance, and of its own where that states too much.
  double added_px2 = sigma_px_ * sigma_px_;
  double scale = 1;
  double stated = 0;
  for (const Left& left : memory_) stated += left.stated_px2;
  stated /= static_cast<double>(memory_.size());
  for (int round = 0; round <= kRounds; ++round) {
    ratios_.clear();
    double sum = 0;
    double count = 0;
    for (const Left& left : memory_) {
      const double q = left.squared_px2 / std::max(left.stated_px2 + added_px2, 1e-12);
      if (round == 0) ratios_.push_back(q);
      if (q >= kInlier) continue;
      sum += q;
      ++count;
    }
    if (round == 0) {
      scale = median(ratios_) / kMedianOfChi2_2;
    } else {
      scale = count == 0 ? 1 : sum / count / kMeanOfInliers;
    }
    const double total = std::max(scale, 1e-4) * (stated + added_px2);
    added_px2 = std::clamp(total - stated, kSmallest_px * kSmallest_px, kLargest_px * kLargest_px);
  }
  sigma_px_ = std::sqrt(added_px2);
  total_px_ = std::sqrt(stated + added_px2);
  settled_ = ratio_of_newest(kLatest) < kTooLittle;
  compare_with_usual();
}

void CornerNoise::compare_with_usual() {
  ++updates_;
  if (updates_ <= kUsualFrom) {
    usual_px_ = total_px_;
    return;
  }
  unusual_ = total_px_ > (unusual_ ? kUsualAgain : kUnusual) * usual_px_;
  // What lasts becomes usual, slowly.
  usual_px_ *= std::pow(total_px_ / usual_px_, 1 / kUsualUpdates);
}

std::optional<CornerNoise::Left> left_by_own_pose(const SetObservation& observation,
                                                  const CameraModel& model,
                                                  const std::optional<Rigid3>& cam_from_marker,
                                                  double sigma_px) {
  MarkerObservation own = observation.observation;
  own.corners_px = observation.detected_px;
  CornerNoise::Left left;
  for (std::size_t i = 0; i < 4; ++i) {
    left.stated_px2 += observation.stated[i].trace() / 8;
    own.whitening[i] = whitening_from_covariance(observation.stated[i] +
                                                 sigma_px * sigma_px * Eigen::Matrix2d::Identity());
  }
  left.variance_px2 = left.stated_px2 + sigma_px * sigma_px;
  Rigid3 pose;
  if (cam_from_marker) {
    pose = *cam_from_marker;
  } else {
    const auto ippe = solve_ippe(model, own.corners_px, own.size_m);
    if (!ippe) return std::nullopt;
    pose = ippe->cam_from_marker[0];
  }
  double squared = 0;
  for (int round = 0; round < 3; ++round) {
    const auto corners = linearize_corners(own, {&model, {}, {}, pose});
    if (!corners) return std::nullopt;
    Matrix6d hessian = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    squared = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Jacobian26 j = own.whitening[i] * (*corners)[i].jacobians.d_marker;
      hessian += j.transpose() * j;
      gradient += j.transpose() * (*corners)[i].residual;
      squared += (*corners)[i].residual.squaredNorm();
    }
    const Vector6d step = -SymmetricFactor<6>(hessian).solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    pose = pose.plus(step);
    squared += gradient.dot(step);  // at the linear optimum
  }
  left.squared_px2 = std::max(squared, 0.0) * left.variance_px2;
  return left;
}

}  // namespace waymark
