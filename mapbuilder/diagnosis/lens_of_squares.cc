#include "mapbuilder/diagnosis/lens_of_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/median.h"
#include "core/camera/lens_kind.h"
#include "core/estimate/ippe.h"
#include "core/estimate/robust_loss.h"
#include "core/geometry/symmetric_factor.h"
#include "mapbuilder/diagnosis/square_equations.h"

namespace waymark {
namespace {

using LensMatrix = Eigen::Matrix<double, kIntrinsicNumbers, kIntrinsicNumbers>;
using PoseByLens = Eigen::Matrix<double, 6, kIntrinsicNumbers>;

constexpr std::size_t kFewest = 20;
constexpr std::size_t kMost = 300;
/// Squares that tell a start from another.
constexpr std::size_t kCoarse = 80;

/// Misfit of IPPE's poses, good enough to tell starts apart; a square that has no pose counts as
/// one that fits badly.
double roughly_px(const CameraModel& camera, std::span<const ImageCorners> squares) {
  std::vector<double> rms_px;
  for (const ImageCorners& square : squares) {
    const auto solutions = solve_ippe(camera, square, 1.0);
    rms_px.push_back(solutions ? solutions->rms_px[0] : std::numeric_limits<double>::infinity());
  }
  return upper_median(rms_px);
}

/// What is stated and what may be meant: other focal lengths with the principal point as stated, in
/// the middle, or of another resolution like them; the lens as stated or straight; images squeezed
/// from 4:3 to 16:9 or back.
std::vector<CameraParameters> starts_near(const CameraParameters& stated) {
  std::vector<CameraParameters> starts;
  constexpr int kSteps = 6;  // each way, by a third of an octave: a factor of four
  for (int step = -kSteps; step <= kSteps; ++step) {
    const double factor = std::pow(4.0, static_cast<double>(step) / kSteps);
    CameraParameters focal = stated;
    focal.fu_px *= factor;
    focal.fv_px *= factor;
    CameraParameters middle = focal;
    middle.pu_px = 0.5 * (stated.width_px - 1);
    middle.pv_px = 0.5 * (stated.height_px - 1);
    CameraParameters resized = focal;
    resized.pu_px = (stated.pu_px + 0.5) * factor - 0.5;
    resized.pv_px = (stated.pv_px + 0.5) * factor - 0.5;
    for (CameraParameters start : {focal, middle, resized}) {
      starts.push_back(start);
      start.coefficients = plain_coefficients(start.distortion);
      starts.push_back(start);
    }
    for (const double squeeze : {0.75, 4.0 / 3.0}) {
      starts.push_back(focal);
      starts.back().fv_px *= squeeze;
    }
  }
  return starts;
}

/// A straight lens that may bend.
CameraParameters with_lens(CameraParameters p) {
  if (p.distortion == Distortion::none) p.distortion = Distortion::radtan;
  return p;
}

CameraParameters moved(const CameraParameters& p, const IntrinsicsVector& by) {
  return with_intrinsics(p, intrinsics_of(p) + by);
}

/// Fits a camera and the squares' own poses together, robustly (Tukey's biweight at six times what
/// corners are worth).
class LensFit {
 public:
  LensFit(const CameraModel& start, std::span<const ImageCorners> squares) : camera_(start) {
    for (const ImageCorners& square : squares) {
      if (const auto pose = own_pose(camera_, square)) squares_.push_back({square, *pose});
    }
  }

  /// A lens of many coefficients first as one of few, then by one more and one more: from afar the
  /// further ones lead astray.
  void run() {
    constexpr int kFew = 4;
    const int count = lens_kind(camera_.parameters().distortion).count();
    for (int few = kFew; few < count; ++few) run_with(few);
    run_with(kMaxCoefficients);
  }

  [[nodiscard]] LensOfSquares result() const {
    return {camera_.parameters(), own_px_of(squared(camera_, poses()))};
  }

 private:
  /// The first `coefficients` vary.
  void run_with(int coefficients) {
    coefficients_ = coefficients;
    constexpr int kIterations = 30;
    double damping = 1e-3;
    double cost = cost_of(camera_, poses());
    for (int i = 0; i < kIterations && damping < 1e8; ++i) {
      sigma_px_ = std::max(1e-3, own_px_of(squared(camera_, poses())));
      cost = cost_of(camera_, poses());
      const Step step = solve(damping);
      const auto camera = CameraModel::create(moved(camera_.parameters(), step.lens));
      const double next = camera && sees_all(*camera) ? cost_of(*camera, step.poses)
                                                      : std::numeric_limits<double>::infinity();
      if (!(next < cost)) {
        damping *= 8;
        continue;
      }
      camera_ = *camera;
      for (std::size_t s = 0; s < squares_.size(); ++s) squares_[s].pose = step.poses[s];
      damping = std::max(1e-9, damping * 0.2);
      constexpr double kNegligible = 1e-6;
      if (cost - next < kNegligible * cost) break;
    }
  }

  struct Square {
    ImageCorners corners_px;
    Rigid3 pose;
  };
  struct Step {
    IntrinsicsVector lens = IntrinsicsVector::Zero();
    std::vector<Rigid3> poses;
  };

  /// A lens that ends short of what was seen is not the one.
  [[nodiscard]] bool sees_all(const CameraModel& camera) const {
    return std::all_of(squares_.begin(), squares_.end(),
                       [&](const Square& square) { return camera.covers_all(square.corners_px); });
  }

  [[nodiscard]] std::vector<Rigid3> poses() const {
    std::vector<Rigid3> all;
    for (const Square& square : squares_) all.push_back(square.pose);
    return all;
  }

  /// Squared residual per square (px²).
  [[nodiscard]] std::vector<double> squared(const CameraModel& camera,
                                            const std::vector<Rigid3>& poses) const {
    std::vector<double> all;
    for (std::size_t s = 0; s < squares_.size(); ++s) {
      const auto one = linearize_square(camera, squares_[s].corners_px, poses[s]);
      all.push_back(one ? one->residual.squaredNorm() : std::numeric_limits<double>::infinity());
    }
    return all;
  }

  static constexpr double kScale = 6.0;  // sigmas: nearly all of χ² with two freedoms

  [[nodiscard]] double cost_of(const CameraModel& camera, const std::vector<Rigid3>& poses) const {
    double cost = prior_cost(camera.parameters());
    for (const double s : squared(camera, poses)) {
      cost += robust_cost(Loss::tukey, kScale, s / (sigma_px_ * sigma_px_));
    }
    return cost;
  }

  /// What any lens is like, one standard deviation: it holds what the squares leave open.
  [[nodiscard]] IntrinsicsVector prior_information() const {
    const CameraParameters& p = camera_.parameters();
    IntrinsicsVector sigma = IntrinsicsVector::Ones();
    sigma.head<4>() << 10.0 * p.width_px, 10.0 * p.width_px, 0.15 * p.width_px, 0.15 * p.height_px;
    const LensKind& kind = lens_kind(p.distortion);
    for (int k = 0; k < kind.count(); ++k) {
      sigma[4 + k] = kind.coefficients[static_cast<std::size_t>(k)].spread;
    }
    return sigma.cwiseAbs2().cwiseInverse();
  }
  [[nodiscard]] static IntrinsicsVector off_prior(const CameraParameters& p) {
    CameraParameters middling = p;
    middling.pu_px = 0.5 * (p.width_px - 1);
    middling.pv_px = 0.5 * (p.height_px - 1);
    middling.coefficients = usual_coefficients(p.distortion);
    return intrinsics_of(p) - intrinsics_of(middling);
  }
  [[nodiscard]] double prior_cost(const CameraParameters& p) const {
    const IntrinsicsVector off = off_prior(p);
    return off.dot(prior_information().cwiseProduct(off));
  }

  [[nodiscard]] Step solve(double damping) const {
    struct Eliminated {
      Vector6d offset = Vector6d::Zero();
      PoseByLens back = PoseByLens::Zero();
    };
    const IntrinsicsVector prior = prior_information();
    LensMatrix hessian = prior.asDiagonal();
    IntrinsicsVector gradient = prior.cwiseProduct(off_prior(camera_.parameters()));
    gradient.tail(kMaxCoefficients - coefficients_).setZero();
    std::vector<Eliminated> eliminated(squares_.size());
    for (std::size_t s = 0; s < squares_.size(); ++s) {
      auto one = linearize_square(camera_, squares_[s].corners_px, squares_[s].pose);
      if (!one) continue;
      one->by_lens.rightCols(kMaxCoefficients - coefficients_).setZero();
      const double weight = robust_weight(Loss::tukey, kScale,
                                          one->residual.squaredNorm() / (sigma_px_ * sigma_px_)) /
                            (sigma_px_ * sigma_px_);
      if (weight <= 0) continue;
      Matrix6d pose = one->by_pose.transpose() * one->by_pose;
      pose.diagonal() *= 1.0 + damping;
      const SymmetricFactor<6> factor(pose);
      const PoseByLens cross = one->by_pose.transpose() * one->by_lens;
      eliminated[s].offset = factor.solve(one->by_pose.transpose() * one->residual);
      for (Eigen::Index k = 0; k < cross.cols(); ++k) {
        eliminated[s].back.col(k) = factor.solve(cross.col(k));
      }
      hessian += weight *
                 (one->by_lens.transpose() * one->by_lens - cross.transpose() * eliminated[s].back);
      gradient += weight * (one->by_lens.transpose() * one->residual -
                            cross.transpose() * eliminated[s].offset);
    }
    hessian.diagonal() *= 1.0 + damping;
    Step step;
    step.lens = -SymmetricFactor<kIntrinsicNumbers>(hessian).solve(gradient);
    for (std::size_t s = 0; s < squares_.size(); ++s) {
      step.poses.push_back(
          squares_[s].pose.plus(-(eliminated[s].offset + eliminated[s].back * step.lens)));
    }
    return step;
  }

  CameraModel camera_;
  std::vector<Square> squares_;
  double sigma_px_ = 1.0;
  int coefficients_ = kMaxCoefficients;  ///< that vary, the first ones
};

/// The starts that fit the squares best, roughly.
std::vector<CameraModel> best_starts(const CameraParameters& stated,
                                     std::span<const ImageCorners> squares) {
  constexpr std::size_t kBest = 3;
  std::vector<std::pair<double, CameraModel>> starts;
  for (const CameraParameters& start : starts_near(stated)) {
    if (auto model = CameraModel::create(start)) {
      const double misfit_px = roughly_px(*model, squares);
      starts.emplace_back(misfit_px, *std::move(model));
    }
  }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<CameraModel> best;
  for (const auto& start : starts) {
    if (best.size() < kBest) best.push_back(start.second);
  }
  return best;
}

LensOfSquares fitted_to(const CameraModel& start, std::span<const ImageCorners> squares) {
  LensFit fit(start, squares);
  fit.run();
  return fit.result();
}

}  // namespace

double own_misfit_px(const CameraModel& camera, std::span<const ImageCorners> squares) {
  std::vector<double> squared;
  for (const ImageCorners& square : spread(squares, kMost)) {
    if (const auto one = own_misfit_px2(camera, square)) squared.push_back(*one);
  }
  return own_px_of(std::move(squared));
}

std::optional<LensOfSquares> lens_of_squares(const CameraParameters& stated,
                                             std::span<const ImageCorners> squares) {
  if (squares.size() < kFewest) return std::nullopt;
  const std::vector<ImageCorners> many = spread(squares, kMost);
  std::optional<LensOfSquares> best;
  for (const CameraModel& start : best_starts(with_lens(stated), spread(squares, kCoarse))) {
    const LensOfSquares found = fitted_to(start, many);
    if (!best || found.own_px < best->own_px) best = found;
  }
  return best;
}

std::optional<LensBySquares> judge_lens(const CameraModel& stated,
                                        std::span<const ImageCorners> squares) {
  if (squares.size() < kFewest) return std::nullopt;
  LensBySquares judged;
  judged.squares = squares.size();
  const std::vector<ImageCorners> few = spread(squares, kCoarse);
  judged.stated_px = own_misfit_px(stated, few);
  const auto near = CameraModel::create(with_lens(stated.parameters()));
  if (!near) return std::nullopt;
  judged.best = fitted_to(*near, few);
  // Where no camera near the stated one fits well, the way to the one that does may be barred.
  constexpr double kDoubtful_px = 0.3;
  if (!judged.contradicts() && judged.best.own_px < kDoubtful_px) return judged;
  const auto anywhere = lens_of_squares(stated.parameters(), squares);
  if (anywhere && anywhere->own_px < judged.best.own_px) judged.best = *anywhere;
  return judged;
}

}  // namespace waymark
