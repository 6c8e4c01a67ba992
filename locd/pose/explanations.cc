#include "locd/pose/explanations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

constexpr double kMoved_m = 0.2;
constexpr double kTurned_rad = 0.2;

/// Λ and the fault of numbers with information Ã, evidence b̃ and width B (all of them scaled by
/// B): Λ = ½ ωᵀ(I + Ω)⁻¹ω − ½ ln det(I + Ω).
template <int N>
struct Gain {
  double gain = 0;
  double chi2 = 0;
  Eigen::Matrix<double, N, 1> fault;  ///< in widths
  Eigen::Matrix<double, N, 1> sigma;
};

template <int N>
Gain<N> gain_of(const Eigen::Matrix<double, N, N>& omega, const Eigen::Matrix<double, N, 1>& pull) {
  Eigen::Matrix<double, N, N> with_prior = omega;
  with_prior.diagonal().array() += 1;
  const Eigen::LLT<Eigen::Matrix<double, N, N>> factor(with_prior);
  Gain<N> result;
  result.fault = factor.solve(pull);
  const Eigen::Matrix<double, N, N> covariance =
      factor.solve(Eigen::Matrix<double, N, N>::Identity());
  result.sigma = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  double half_log_det = 0;
  for (int i = 0; i < N; ++i) half_log_det += std::log(factor.matrixLLT()(i, i));
  result.gain = 0.5 * pull.dot(result.fault) - half_log_det;
  result.chi2 = result.fault.dot(with_prior * result.fault);
  return result;
}

}  // namespace

CalibrationVector Explanations::widths_of(AlertKind kind) {
  CalibrationVector widths = CalibrationVector::Zero();
  switch (kind) {
    case AlertKind::extrinsics_off:
      widths.head<3>().setConstant(0.1);
      widths.segment<3>(3).setConstant(0.05);
      break;
    case AlertKind::lens_off:
      widths.segment<4>(kFocal) << 0.03, 20, 20, 0.1;
      break;
    case AlertKind::stamps_skewed:
      widths[kStamp] = 0.1;
      break;
    case AlertKind::readout_off:
      widths[kReadout] = 0.03;
      break;
    default:
      break;
  }
  return widths;
}

Explanations::Explanations(std::size_t cameras, const MapIndex& map)
    : map_(map), cameras_(cameras) {
  slots_.reserve(Evidence::kMostMarkers);
  scores_.reserve(4 * cameras + Evidence::kMostMarkers);
}

/// Gathers what was seen, and eliminates all numbers under their prior.
void Explanations::reduce(const Evidence::System& system, const CalibrationPrior& prior,
                          std::span<const Explanation> believed) {
  slots_.clear();
  for (std::size_t i = 0; i < system.views.size(); ++i) {
    if (system.views[i] > 0) slots_.push_back(i);
  }
  const Eigen::Index calibration = prior.size();
  const Eigen::Index size = calibration + 6 * static_cast<Eigen::Index>(slots_.size());
  const auto at = [&](std::size_t i) {
    return calibration + 6 * static_cast<Eigen::Index>(slots_[i]);
  };
  information_.resize(size, size);
  evidence_.resize(size);
  information_.topLeftCorner(calibration, calibration) =
      system.information.topLeftCorner(calibration, calibration);
  evidence_.head(calibration) = system.evidence.head(calibration);
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const Eigen::Index to = calibration + 6 * static_cast<Eigen::Index>(i);
    evidence_.segment<6>(to) = system.evidence.segment<6>(at(i));
    information_.block(to, 0, 6, calibration) = system.information.block(at(i), 0, 6, calibration);
    information_.block(0, to, calibration, 6) = system.information.block(0, at(i), calibration, 6);
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      information_.block<6, 6>(to, calibration + 6 * static_cast<Eigen::Index>(k)) =
          system.information.block<6, 6>(at(i), at(k));
    }
  }
  // R Rᵀ is the prior; numbers that can't be wrong have no column.
  Eigen::MatrixXd known = prior.covariance();
  for (const Explanation& e : believed) {
    if (e.of_marker()) continue;
    known.diagonal()
        .segment<kCalibrationNumbers>(
            CalibrationPrior::first_of(static_cast<std::size_t>(e.camera)))
        .array() += (widths_of(e.kind).array() / CalibrationPrior::units().array()).square();
  }
  root_.setZero(size, size);
  root_.topLeftCorner(calibration, calibration) = known.llt().matrixL();
  Eigen::Index column = calibration;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Matrix6d covariance = map_.marker(system.markers[slots_[i]]).covariance;
    const Explanation own{AlertKind::marker_moved, -1, system.markers[slots_[i]]};
    if (std::find(believed.begin(), believed.end(), own) != believed.end()) {
      covariance.diagonal().head<3>().array() += kMoved_m * kMoved_m;
      covariance.diagonal().tail<3>().array() += kTurned_rad * kTurned_rad;
    } else if (covariance.diagonal().maxCoeff() <= 0) {
      continue;
    }
    covariance.diagonal().array() += 1e-12;
    const Eigen::Index row = calibration + 6 * static_cast<Eigen::Index>(i);
    root_.block<6, 6>(row, column) = Matrix6d(covariance.llt().matrixL());
    column += 6;
  }
  const auto root = root_.leftCols(column);
  reduced_.noalias() = root.transpose() * information_;
  Eigen::MatrixXd kernel = reduced_ * root;
  kernel.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> factor(kernel);
  factor.matrixL().solveInPlace(reduced_);
  answered_ = root.transpose() * evidence_;
  factor.matrixL().solveInPlace(answered_);
}

void Explanations::score_camera(const Evidence::System& system, int camera, AlertKind kind) {
  const Eigen::Index at = CalibrationPrior::first_of(static_cast<std::size_t>(camera));
  using Square = Eigen::Matrix<double, kCalibrationNumbers, kCalibrationNumbers>;
  const auto reduced = reduced_.middleCols<kCalibrationNumbers>(at);
  const Square information = information_.block<kCalibrationNumbers, kCalibrationNumbers>(at, at) -
                             reduced.transpose() * reduced;
  const CalibrationVector evidence =
      evidence_.segment<kCalibrationNumbers>(at) - reduced.transpose() * answered_;
  // Numbers without width cost nothing and explain nothing.
  const CalibrationVector widths = widths_of(kind);
  const CalibrationVector scaled = widths.cwiseQuotient(CalibrationPrior::units());
  const auto gain = gain_of<kCalibrationNumbers>(
      scaled.asDiagonal() * information * scaled.asDiagonal(), scaled.asDiagonal() * evidence);
  Score& score = scores_.emplace_back();
  score.what = {kind, camera, 0};
  score.gain = gain.gain;
  score.chi2 = gain.chi2;
  score.camera = gain.fault.cwiseProduct(widths);
  score.camera_sigma = gain.sigma.cwiseProduct(widths);
  score.views = system.sets_of_camera[static_cast<std::size_t>(camera)];
}

void Explanations::score_marker(const Evidence::System& system, Eigen::Index at, std::size_t slot) {
  const auto reduced = reduced_.middleCols<6>(at);
  const Matrix6d information = information_.block<6, 6>(at, at) - reduced.transpose() * reduced;
  const Vector6d evidence = evidence_.segment<6>(at) - reduced.transpose() * answered_;
  Vector6d widths;
  widths << Eigen::Vector3d::Constant(kMoved_m), Eigen::Vector3d::Constant(kTurned_rad);
  const auto gain = gain_of<6>(widths.asDiagonal() * information * widths.asDiagonal(),
                               widths.asDiagonal() * evidence);
  Score& score = scores_.emplace_back();
  score.what = {AlertKind::marker_moved, -1, system.markers[slot]};
  score.gain = gain.gain;
  score.chi2 = gain.chi2;
  score.marker = gain.fault.cwiseProduct(widths);
  score.views = system.views[slot];
}

std::span<const Score> Explanations::judge(const Evidence::System& system,
                                           const CalibrationPrior& prior,
                                           std::span<const Explanation> believed) {
  reduce(system, prior, believed);
  scores_.clear();
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (system.sets_of_camera[c] == 0) continue;
    const int camera = static_cast<int>(c);
    if (cameras_ > 1) score_camera(system, camera, AlertKind::extrinsics_off);
    score_camera(system, camera, AlertKind::lens_off);
    if (cameras_ > 1) score_camera(system, camera, AlertKind::stamps_skewed);
    score_camera(system, camera, AlertKind::readout_off);
  }
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    score_marker(system, prior.size() + 6 * static_cast<Eigen::Index>(i), slots_[i]);
  }
  std::sort(scores_.begin(), scores_.end(),
            [](const Score& a, const Score& b) { return a.gain > b.gain; });
  return scores_;
}

std::optional<Score> Explanations::score_of(const Explanation& what) const {
  const auto found =
      std::find_if(scores_.begin(), scores_.end(), [&](const Score& s) { return s.what == what; });
  if (found == scores_.end()) return std::nullopt;
  return *found;
}

}  // namespace waymark
