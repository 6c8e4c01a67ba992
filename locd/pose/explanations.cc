#include "locd/pose/explanations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/dense_products.h"

namespace waymark {
namespace {

constexpr std::array<AlertKind, 4> kKindsOfCamera{AlertKind::extrinsics_off, AlertKind::lens_off,
                                                  AlertKind::stamps_skewed, AlertKind::readout_off};
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

Explanations::Explanations(const CalibrationPrior& prior, const MapIndex& map)
    : map_(map), cameras_(prior.cameras()) {
  own_roots_.reserve(Evidence::kMostMarkers);
  scores_.reserve(kKindsOfCamera.size() * cameras_ + Evidence::kMostMarkers);
  const Eigen::Index markers = 6 * static_cast<Eigen::Index>(Evidence::kMostMarkers);
  const Eigen::Index size = prior.numbers() + markers;
  const Eigen::Index freedoms = prior.size() + markers;
  shared_root_.setZero(prior.modes() + size, prior.size());
  kernel_.setZero(freedoms, freedoms);
  reduced_.setZero(freedoms, size);
  answered_.setZero(freedoms);
}

bool Explanations::take_roots() {
  // Numbers, then modes, then what markers follow of the modes.
  auto shared = shared_root_.topRows(shared_);
  shared = prior_->covariance();
  // What is wrong with a camera may be more than what was named, or change with the motion: it
  // takes no part in poses, and nobody else is to explain what it sees.
  for (const Explanation& e : believed_) {
    if (e.of_marker()) continue;
    const auto first = CalibrationPrior::first_of(static_cast<std::size_t>(e.camera));
    for (const AlertKind kind : kKindsOfCamera) {
      shared.diagonal().segment<kCalibrationNumbers>(first).array() +=
          (widths_of(kind).array() / CalibrationPrior::units().array()).square();
    }
  }
  if (!factor_in_place(shared)) return false;
  shared.triangularView<Eigen::StrictlyUpper>().setZero();
  own_roots_.clear();
  for (std::size_t i = 0; i < system_->markers.size(); ++i) {
    const std::size_t map_index = system_->markers[i];
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(i);
    auto following = shared_root_.middleRows<6>(shared_ + row);
    following.setZero();
    if (prior_->modes() > 0) {
      const Eigen::Matrix<double, 6, kMapModes> modes = map_.marker(map_index).modes.cast<double>();
      add_product(modes, shared.bottomRows(kMapModes), following);
    }
    Matrix6d own = map_.own_covariance(map_index);
    const Explanation moved{AlertKind::marker_moved, -1, map_index};
    if (std::find(believed_.begin(), believed_.end(), moved) != believed_.end()) {
      own.diagonal().head<3>().array() += kMoved_m * kMoved_m;
      own.diagonal().tail<3>().array() += kTurned_rad * kTurned_rad;
    } else if (own.diagonal().maxCoeff() <= 0) {
      continue;
    }
    own.diagonal().array() += 1e-12;
    own_roots_.push_back({numbers_ + row, Matrix6d(own.llt().matrixL())});
  }
  return true;
}

void Explanations::multiply_by_roots() {
  const Eigen::Index markers = size_ - numbers_;
  freedoms_ = shared_ + 6 * static_cast<Eigen::Index>(own_roots_.size());
  const auto a = system_->information.topLeftCorner(size_, size_);
  const auto of_numbers = shared_root_.topRows(numbers_);
  const auto of_markers = shared_root_.middleRows(shared_, markers);
  auto reduced = reduced_.topLeftCorner(freedoms_, size_);
  reduced.topRows(shared_).setZero();
  add_transposed_product(of_numbers, a.topRows(numbers_), reduced.topRows(shared_));
  if (prior_->modes() > 0) {  // markers follow nothing else
    add_transposed_product(of_markers, a.bottomRows(markers), reduced.topRows(shared_));
  }
  answered_.head(shared_).noalias() = of_numbers.transpose() * system_->evidence.head(numbers_);
  answered_.head(shared_).noalias() +=
      of_markers.transpose() * system_->evidence.segment(numbers_, markers);
  Eigen::Index at = shared_;
  for (const OwnRoot& own : own_roots_) {
    reduced.middleRows<6>(at).noalias() = own.root.transpose() * a.middleRows<6>(own.row);
    answered_.segment<6>(at) = own.root.transpose() * system_->evidence.segment<6>(own.row);
    at += 6;
  }
}

void Explanations::make_kernel() {
  const Eigen::Index markers = size_ - numbers_;
  const auto reduced = reduced_.topLeftCorner(freedoms_, size_);
  auto kernel = kernel_.topLeftCorner(freedoms_, freedoms_);
  kernel.setIdentity();
  add_product(reduced.leftCols(numbers_), shared_root_.topRows(numbers_), kernel.leftCols(shared_));
  if (prior_->modes() > 0) {
    add_product(reduced.rightCols(markers), shared_root_.middleRows(shared_, markers),
                kernel.leftCols(shared_));
  }
  Eigen::Index at = shared_;
  for (const OwnRoot& own : own_roots_) {
    kernel.middleCols<6>(at).noalias() += reduced.middleCols<6>(own.row) * own.root;
    at += 6;
  }
}

void Explanations::eliminate(Eigen::Index first, Eigen::Index count) {
  solve_in_place(kernel_.topLeftCorner(freedoms_, freedoms_),
                 reduced_.topRows(freedoms_).middleCols(first, count));
}

void Explanations::begin(const Evidence::System& system, const CalibrationPrior& prior,
                         std::span<const Explanation> believed) {
  system_ = &system;
  prior_ = &prior;
  believed_ = believed;
  numbers_ = prior.numbers();
  shared_ = prior.size();
  size_ = numbers_ + 6 * static_cast<Eigen::Index>(system.markers.size());
  scores_.clear();
  step_ = 0;
}

bool Explanations::advance() {
  if (step_ < kSteps) step_ = do_step(step_) ? step_ + 1 : kSteps;
  return step_ == kSteps;
}

bool Explanations::do_step(int step) {
  switch (step) {
    case 0:
      return take_roots();
    case 1:
      multiply_by_roots();
      return true;
    case 2:
      make_kernel();
      return true;
    case 3: {
      const auto kernel = kernel_.topLeftCorner(freedoms_, freedoms_);
      if (!factor_in_place(kernel)) return false;
      solve_in_place(kernel, answered_.head(freedoms_));
      return true;
    }
    default: {
      // Column by column, in as many parts as steps are left.
      constexpr int kFirst = 4;
      constexpr int kParts = kSteps - kFirst;
      const Eigen::Index first = size_ * (step - kFirst) / kParts;
      eliminate(first, size_ * (step - kFirst + 1) / kParts - first);
      if (step + 1 == kSteps) score_all();
      return true;
    }
  }
}

void Explanations::score_camera(int camera, AlertKind kind) {
  const Eigen::Index at = CalibrationPrior::first_of(static_cast<std::size_t>(camera));
  using Square = Eigen::Matrix<double, kCalibrationNumbers, kCalibrationNumbers>;
  const auto reduced = reduced_.topRows(freedoms_).middleCols<kCalibrationNumbers>(at);
  Square information = system_->information.block<kCalibrationNumbers, kCalibrationNumbers>(at, at);
  information.noalias() -= reduced.transpose() * reduced;
  CalibrationVector evidence = system_->evidence.segment<kCalibrationNumbers>(at);
  evidence.noalias() -= reduced.transpose() * answered_.head(freedoms_);
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
  score.views = system_->sets_of_camera[static_cast<std::size_t>(camera)];
  const CameraMask bit = camera_bit(static_cast<std::size_t>(camera));
  score.markers =
      static_cast<int>(std::count_if(system_->seen_by.begin(), system_->seen_by.end(),
                                     [&](CameraMask mask) { return (mask & bit) != 0; }));
}

void Explanations::score_marker(Eigen::Index at, std::size_t slot) {
  const auto reduced = reduced_.topRows(freedoms_).middleCols<6>(at);
  Matrix6d information = system_->information.block<6, 6>(at, at);
  information.noalias() -= reduced.transpose() * reduced;
  Vector6d evidence = system_->evidence.segment<6>(at);
  evidence.noalias() -= reduced.transpose() * answered_.head(freedoms_);
  Vector6d widths;
  widths << Eigen::Vector3d::Constant(kMoved_m), Eigen::Vector3d::Constant(kTurned_rad);
  const auto gain = gain_of<6>(widths.asDiagonal() * information * widths.asDiagonal(),
                               widths.asDiagonal() * evidence);
  Score& score = scores_.emplace_back();
  score.what = {AlertKind::marker_moved, -1, system_->markers[slot]};
  score.gain = gain.gain;
  score.chi2 = gain.chi2;
  score.marker = gain.fault.cwiseProduct(widths);
  score.views = system_->views[slot];
}

void Explanations::score_all() {
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (system_->sets_of_camera[c] == 0) continue;
    const int camera = static_cast<int>(c);
    for (const AlertKind kind : kKindsOfCamera) {
      // One camera alone is the rig, and its clock the vehicle's.
      const bool of_several = kind == AlertKind::extrinsics_off || kind == AlertKind::stamps_skewed;
      if (cameras_ > 1 || !of_several) score_camera(camera, kind);
    }
  }
  for (std::size_t i = 0; i < system_->markers.size(); ++i) {
    score_marker(numbers_ + 6 * static_cast<Eigen::Index>(i), i);
  }
  std::sort(scores_.begin(), scores_.end(),
            [](const Score& a, const Score& b) { return a.gain > b.gain; });
}

std::span<const Score> Explanations::judge(const Evidence::System& system,
                                           const CalibrationPrior& prior,
                                           std::span<const Explanation> believed) {
  begin(system, prior, believed);
  while (!advance()) {
  }
  return scores_;
}

std::optional<Score> Explanations::score_of(const Explanation& what) const {
  const auto found =
      std::find_if(scores_.begin(), scores_.end(), [&](const Score& s) { return s.what == what; });
  if (found == scores_.end()) return std::nullopt;
  return *found;
}

}  // namespace waymark
