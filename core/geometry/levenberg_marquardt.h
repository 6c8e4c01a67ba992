#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "core/geometry/symmetric_factor.h"

namespace waymark {

/// A least-squares problem's quadratic approximation at one place, in N unknowns.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> hessian = Eigen::Matrix<double, N, N>::Zero();   ///< Σ Jᵀ w J
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();  ///< Σ Jᵀ w r
  double cost = 0;                                                             ///< Σ ρ, sigmas²
  int corners = 0;  ///< (or pixels) that could be evaluated
};

/// How Levenberg–Marquardt goes.
struct LevenbergMarquardtOptions {
  int max_iterations = 30;
  double initial_damping = 1e-4;      ///< relative to the Hessian's diagonal
  double negligible_decrease = 1e-7;  ///< sigmas²: a step that promises less is the last
};

/// Where it ended, and the equations there.
template <int N, typename Place>
struct LocalOptimum {
  Place place;
  NormalEquations<N> equations;
};

/// Goes on to the optimum wherever it comes past.
struct ToTheEnd {
  template <typename Place>
  bool operator()(const Place& /*place*/) const {
    return false;
  }
};

/// Levenberg–Marquardt over a few unknowns. `linearize(place)` gives the NormalEquations<N> there,
/// `moved(place, step)` the place a step away; steps that raise the cost are taken back. nullopt
/// when fewer than three corners can be evaluated at the start, or where it comes to a place of
/// which `given_up(place)` holds. No allocation.
template <int N, typename Place, typename Linearize, typename Moved, typename GivenUp = ToTheEnd>
[[nodiscard]] std::optional<LocalOptimum<N, Place>> minimize(
    const Place& start, const LevenbergMarquardtOptions& options, const Linearize& linearize,
    const Moved& moved, const GivenUp& given_up = {}) {
  constexpr int kFewestCorners = 3;
  LocalOptimum<N, Place> here{start, linearize(start)};
  if (here.equations.corners < kFewestCorners) return std::nullopt;
  double damping = options.initial_damping;
  for (int i = 0; i < options.max_iterations; ++i) {
    Eigen::Matrix<double, N, N> damped = here.equations.hessian;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;
    const Eigen::Matrix<double, N, 1> step =
        -SymmetricFactor<N>(damped).solve(here.equations.gradient);
    if (!step.allFinite()) break;
    const double promised = -step.dot(here.equations.gradient);
    const Place next = moved(here.place, step);
    const NormalEquations<N> there = linearize(next);
    if (there.corners >= kFewestCorners && there.cost <= here.equations.cost) {
      if (given_up(next)) return std::nullopt;
      here = {next, there};
      damping = std::max(1e-9, damping * 0.2);
    } else {
      damping = std::max(damping * 8.0, 1e-6);
    }
    if (promised < options.negligible_decrease || damping > 1e12) break;
  }
  return here;
}

}  // namespace waymark
