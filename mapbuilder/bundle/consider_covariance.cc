#include "mapbuilder/bundle/consider_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "mapbuilder/bundle/sensitivity_modes.h"

namespace waymark {
namespace {

/// Of all frame sets' equations so much is added to those of one half, so that a marker that it
/// does not see stays determined, where all have it.
constexpr double kOfAll = 0.01;
/// Squared sigmas: corners that fit so well are exact, and tell nothing of noise.
constexpr double kNoResiduals = 1e-12;
/// Rounds in which step and noise settle.
constexpr int kNoiseRounds = 2;

/// What the scale's uncertainty is told apart by.
constexpr std::array<std::string_view, 5> kScaleParts{
    "places of cameras", "focal lengths", "principal points and lenses", "edges", "sizes"};

void add(const BlockMatrix& more, double factor, BlockMatrix& to) {
  for (std::size_t b = 0; b < to.blocks.size(); ++b) to.blocks[b] += factor * more.blocks[b];
}

/// The estimated columns, or the others.
std::vector<Eigen::Index> columns_that(const std::vector<char>& estimated, bool are) {
  std::vector<Eigen::Index> columns;
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    if ((estimated[i] != 0) == are) columns.push_back(static_cast<Eigen::Index>(i));
  }
  return columns;
}

/// Of a positive definite matrix; by its own scales first, for units do not compare.
Eigen::MatrixXd symmetric_inverse(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  const Eigen::LDLT<Eigen::MatrixXd> factor(scale.asDiagonal() * matrix * scale.asDiagonal());
  const Eigen::MatrixXd inverse = factor.solve(unit);
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

/// Makes what is said of one map, step by step.
class MapConsiderer {
 public:
  MapConsiderer(const BundleProblem& problem, const Estimate& estimate, int threads)
      : problem_(problem, estimate, threads),
        all_(problem_.equations()),
        inverse_(MarkerInverse::of(all_.markers)) {}

  [[nodiscard]] std::optional<ConsideredMap> make() {
    if (!inverse_) return std::nullopt;
    made_.markers = all_.markers.markers;
    made_.rigs = problem_.rigs();
    sensitivity_ = -inverse_->solve(all_.mixed);
    take_noise();
    take_parameters();
    take_covariances();
    take_modes();
    take_scale();
    take_halves();
    return std::move(made_);
  }

 private:
  [[nodiscard]] Eigen::Index rows() const { return sensitivity_.rows(); }

  /// A = Q − Mᵀ N⁻¹ M: what the observations tell of the parameters.
  [[nodiscard]] Eigen::MatrixXd told() const {
    const Eigen::MatrixXd a = all_.parameters + all_.mixed.transpose() * sensitivity_;
    return 0.5 * (a + a.transpose());
  }

  /// One joint step: poses, markers and what is considered free, by its prior.
  void take_noise() {
    Eigen::MatrixXd prior = problem_.prior();
    for (const Eigen::Index i : columns_that(problem_.estimated(), true)) {
      prior.row(i).setZero();  // at its optimum already
      prior.col(i).setZero();
    }
    const Eigen::MatrixXd root = square_root_of(prior);
    const Eigen::MatrixXd information = root.transpose() * told() * root;
    const Eigen::VectorXd towards_optimum = -inverse_->solve(all_.gradient.head(rows()));
    const Eigen::VectorXd pull =
        root.transpose() * (all_.gradient.tail(problem_.columns()) +
                            sensitivity_.transpose() * all_.gradient.head(rows()));
    const Eigen::VectorXd stay = Eigen::VectorXd::Zero(problem_.columns());
    const double before = problem_.residuals_after(towards_optimum, stay);
    double share = 1;  // of the variance
    for (int round = 0; round < kNoiseRounds && before > kNoResiduals; ++round) {
      const Eigen::MatrixXd with_prior =
          information / share + Eigen::MatrixXd::Identity(information.rows(), information.cols());
      const Eigen::VectorXd columns = root * -with_prior.ldlt().solve(pull / share);
      const double after =
          problem_.residuals_after(towards_optimum + sensitivity_ * columns, columns);
      share = std::min(1.0, after / before);
    }
    made_.noise_share = std::sqrt(share);
  }

  /// The columns' covariance: prior, or by what estimated them, e_r = −Ξ⁻¹(A_rc e_c + η − F e_r⁰).
  void take_parameters() {
    const std::vector<Eigen::Index> r = columns_that(problem_.estimated(), true);
    const std::vector<Eigen::Index> c = columns_that(problem_.estimated(), false);
    covariance_ = problem_.prior();
    if (!r.empty()) {
      const Eigen::MatrixXd a = told();
      const Eigen::MatrixXd a_rr = a(r, r);
      const Eigen::MatrixXd a_rc = a(r, c);
      const Eigen::MatrixXd held = problem_.held()(r, r);
      const Eigen::MatrixXd xi = symmetric_inverse(a_rr + held);
      Eigen::MatrixXd answer = Eigen::MatrixXd::Identity(covariance_.rows(), covariance_.cols());
      answer(r, r) = Eigen::MatrixXd(xi * held);
      answer(r, c) = Eigen::MatrixXd(-xi * a_rc);
      covariance_ = (answer * covariance_ * answer.transpose()).eval();
      const double variance = made_.noise_share * made_.noise_share;
      covariance_(r, r) += Eigen::MatrixXd(variance * xi * a_rr * xi);
      covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
    }
    root_ = square_root_of(covariance_);
    made_.parameters = problem_.parameters();
    made_.parameters.covariance =
        covariance_.topLeftCorner(made_.parameters.count(), made_.parameters.count());
    moved_ = sensitivity_ * root_;
  }

  void take_covariances() {
    const double variance = made_.noise_share * made_.noise_share;
    std::vector<Matrix6d> noise = inverse_->diagonal();
    made_.of_marker.resize(noise.size());
    for (std::size_t i = 0; i < noise.size(); ++i) {
      ConsideredMap::Marker& marker = made_.of_marker[i];
      const auto moved = moved_.middleRows<6>(static_cast<Eigen::Index>(6 * i));
      marker.within = variance * noise[i];
      marker.metric = marker.within + moved * moved.transpose();
      roots_.push_back(inverse_root(marker.metric));
    }
  }

  void take_modes() {
    Eigen::MatrixXd in_sigmas = moved_;
    for (std::size_t i = 0; i < roots_.size(); ++i) {
      auto of_marker = in_sigmas.middleRows<6>(static_cast<Eigen::Index>(6 * i));
      of_marker = (roots_[i] * of_marker).eval();
    }
    const SensitivityModes modes = sensitivity_modes(in_sigmas, kMapModes);
    made_.dropped_mean = modes.dropped_mean;
    made_.dropped_worst = modes.dropped_worst;
    const auto kept = static_cast<int>(modes.directions.cols());
    const double variance = made_.noise_share * made_.noise_share;
    const auto noise_times = [&](const Eigen::MatrixXd& x) {
      return Eigen::MatrixXd(variance * inverse_->covariance_times(x));
    };
    Eigen::MatrixXd columns(rows(), kMapModes);
    columns << moved_ * modes.directions, leading_columns(noise_times, roots_, kMapModes - kept);
    for (std::size_t i = 0; i < roots_.size(); ++i) {
      made_.of_marker[i].modes =
          columns.middleRows<6>(static_cast<Eigen::Index>(6 * i)).cast<float>();
    }
    const Eigen::Index count = made_.parameters.count();
    made_.cross = Eigen::MatrixXd::Zero(count, kMapModes);
    made_.cross.leftCols(kept) = root_.topRows(count) * modes.directions;
  }

  /// Scale: what moves all positions along themselves.
  void take_scale() {
    const std::vector<Rigid3>& poses = all_.markers.world_from_marker;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Rigid3& pose : poses) centre += pose.translation / static_cast<double>(poses.size());
    Eigen::VectorXd along = Eigen::VectorXd::Zero(rows());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      along.segment<3>(static_cast<Eigen::Index>(6 * i)) = poses[i].translation - centre;
    }
    if (!(along.squaredNorm() > 0)) return;
    along /= along.squaredNorm();
    const double noise =
        made_.noise_share * made_.noise_share * along.dot(inverse_->covariance_times(along).col(0));
    const Eigen::RowVectorXd per_column = along.transpose() * sensitivity_;
    made_.scale.sigma = std::sqrt(std::max(0.0, noise) + (per_column * root_).squaredNorm());
    made_.scale.parts.push_back({"corner noise", std::sqrt(std::max(0.0, noise))});
    for (const std::string_view kind : kScaleParts) take_scale_of(kind, per_column);
    std::stable_sort(made_.scale.parts.begin(), made_.scale.parts.end(),
                     [](const auto& a, const auto& b) { return a.sigma > b.sigma; });
  }

  /// What the parameters of one kind do to the scale.
  void take_scale_of(std::string_view kind, const Eigen::RowVectorXd& per_column) {
    Eigen::RowVectorXd of_kind = per_column;
    for (Eigen::Index i = 0; i < of_kind.size(); ++i) {
      if (part_of(i) != kind) of_kind[i] = 0;
    }
    if (of_kind.isZero(0)) return;
    made_.scale.parts.push_back({kind, (of_kind * root_).norm()});
  }

  /// Which of kScaleParts a column belongs to.
  [[nodiscard]] std::string_view part_of(Eigen::Index column) const {
    if (column >= problem_.parameters().count()) return kScaleParts[2];
    const ConsiderParameter& one = problem_.parameters().all[static_cast<std::size_t>(column)];
    if (one.is_size()) return kScaleParts[4];
    switch (one.of_rig.quantity) {
      case CameraQuantity::position:
      case CameraQuantity::rotation:
        return kScaleParts[0];
      case CameraQuantity::focal:
        return kScaleParts[1];
      case CameraQuantity::edge:
        return kScaleParts[3];
      default:
        return kScaleParts[2];
    }
  }

  /// S of one half of the frame sets; that of all where it does not determine the markers.
  [[nodiscard]] Eigen::MatrixXd sensitivity_of(FrameSetHalf half) {
    ConsiderEquations equations = problem_.equations(half);
    add(all_.markers.information, kOfAll, equations.markers.information);
    equations.mixed += kOfAll * all_.mixed;
    const auto inverse = MarkerInverse::of(equations.markers);
    return inverse ? Eigen::MatrixXd(-inverse->solve(equations.mixed)) : sensitivity_;
  }

  void take_halves() {
    inverse_.reset();  // a factor's memory
    Eigen::MatrixXd apart = sensitivity_of(FrameSetHalf::even);
    apart -= sensitivity_of(FrameSetHalf::odd);
    const Eigen::MatrixXd moved = 0.5 * apart * root_;
    for (std::size_t i = 0; i < made_.of_marker.size(); ++i) {
      const auto of_marker = moved.middleRows<6>(static_cast<Eigen::Index>(6 * i));
      made_.of_marker[i].within += of_marker * of_marker.transpose();
    }
  }

  ConsiderProblem problem_;
  ConsiderEquations all_;
  std::optional<MarkerInverse> inverse_;
  Eigen::MatrixXd sensitivity_;  ///< S
  Eigen::MatrixXd covariance_;   ///< P of all columns
  Eigen::MatrixXd root_;         ///< L
  Eigen::MatrixXd moved_;        ///< S L
  std::vector<Matrix6d> roots_;  ///< inverse, of each marker's C
  ConsideredMap made_;
};

}  // namespace

std::optional<ConsideredMap> considered_map(const BundleProblem& problem, const Estimate& estimate,
                                            int threads) {
  return MapConsiderer(problem, estimate, threads).make();
}

}  // namespace waymark
