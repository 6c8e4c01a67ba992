#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/geometry/rigid3.h"

namespace waymark {

/// How many modes stand for what all considered parameters do to a map.
struct SensitivityModes {
  Eigen::MatrixXd directions;  ///< V: orthonormal columns, in the space of L's columns
  /// Of each marker's variance, mean over its six directions, what the modes leave out.
  double dropped_mean = 0;
  double dropped_worst = 0;
};

/// Of a map's modes, what may be left out (shares of a marker's variance).
inline constexpr double kDroppedMean = 0.01;
inline constexpr double kDroppedWorst = 0.02;

/// The fewest directions, at most `most`, that leave out no more than kDroppedMean of all markers'
/// variance and kDroppedWorst of any one's. `sensitivity`: S L, six rows a marker, in units of each
/// marker's sigmas. V holds the leading eigenvectors of Σ wᵢ (S L)ᵢᵀ (S L)ᵢ; markers that are left
/// out most gain weight in five rounds.
[[nodiscard]] SensitivityModes sensitivity_modes(const Eigen::MatrixXd& sensitivity, int most);

/// G = covariance of markers, by what stands right of it.
using CovarianceTimes = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;

/// R with R C Rᵀ = I, which makes a marker's tangent one in sigmas; rows of directions that C does
/// not have are 0.
[[nodiscard]] Matrix6d inverse_root(const Matrix6d& covariance);

/// T of `count` columns with T Tᵀ ≤ G that holds what most of G is along in sigmas (`roots`: each
/// marker's inverse_root): subspace iteration of three rounds from a fixed start Q, then
/// G Q (Qᵀ G Q)⁻¹ Qᵀ G (Nyström). Columns that G does not have are zero.
[[nodiscard]] Eigen::MatrixXd leading_columns(const CovarianceTimes& covariance_times,
                                              const std::vector<Matrix6d>& roots, int count);

}  // namespace waymark
