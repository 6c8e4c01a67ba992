#pragma once

#include <cmath>

namespace waymark {

/// Where a cost of one number is least, with its standard deviation where the cost counts sigmas².
struct LeastCost {
  double at = 0;
  double cost = 0;
  double sigma = 0;  ///< 0: the cost has no curvature there
};

/// The least of `coarse` over [low, high] in steps, unless none is below that at 0; refined by
/// `cost` within a step.
template <typename Coarse, typename Cost>
LeastCost least_cost(double low, double high, double step, const Coarse& coarse, const Cost& cost) {
  LeastCost least;
  double best = coarse(0.0);
  for (double x = low; x <= high; x += step) {
    const double c = coarse(x);
    if (c >= best) continue;
    best = c;
    least.at = x;
  }
  least.cost = cost(least.at);
  double width = step;
  constexpr int kRounds = 24;
  for (int i = 0; i < kRounds; ++i) {
    for (const double x : {least.at - width, least.at + width}) {
      const double c = cost(x);
      if (c >= least.cost) continue;
      least.cost = c;
      least.at = x;
    }
    width *= 0.6;
  }
  const double h = 0.1 * step;
  const double curvature = (cost(least.at + h) - 2 * least.cost + cost(least.at - h)) / (h * h);
  if (curvature > 0) least.sigma = std::sqrt(2.0 / curvature);
  return least;
}

}  // namespace waymark
