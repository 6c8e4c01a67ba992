#include "mapbuilder/diagnosis/rig_scale_hypothesis.h"

#include <fmt/format.h>

#include <cmath>

#include "mapbuilder/diagnosis/baseline_scale.h"
#include "mapbuilder/diagnosis/least_cost.h"
#include "mapbuilder/diagnosis/length_unit.h"

namespace waymark {
namespace {

/// The rig with baselines so many times as long.
Extrinsics scaled(const Extrinsics& rig, double factor) {
  const Eigen::Vector3d from = rig.front().translation;
  Extrinsics longer = rig;
  for (Rigid3& x : longer) x.translation = from + factor * (x.translation - from);
  return longer;
}

/// Logarithm of the baselines that fit over those stated.
LeastCost fitted_factor(const RigCase& rig) {
  constexpr double kMost = 7.6;  // a factor of 2,000
  constexpr double kStep = 0.08;
  constexpr std::size_t kCoarse = 16;  // instants that tell the factor roughly
  const RigFit& fit = rig.fit();
  const std::size_t every = 1 + fit.judged().size() / (kCoarse + 1);
  const auto coarse = [&](double log_factor) {
    const Extrinsics places = scaled(rig.stated(), std::exp(log_factor));
    double sum = 0;
    for (std::size_t j = 0; j < fit.judged().size(); j += every) {
      sum += fit.cost(rig.tracks(), places, {j, j + 1});
    }
    return sum;
  };
  const auto cost = [&](double log_factor) {
    return fit.cost(rig.tracks(), scaled(rig.stated(), std::exp(log_factor)), fit.all());
  };
  return least_cost(-kMost, kMost, kStep, coarse, cost);
}

RigHypothesis unit_hypothesis(const RigCase& rig, const LengthUnit& unit, double factor,
                              double relative_sigma) {
  RigHypothesis h = rig.hypothesis();
  h.listed = true;
  RigExplanation& e = h.explanation;
  e.cause = Cause::rig_unit;
  e.cameras = rig.all_but_first();
  e.value = 1.0 / factor;
  e.sigma = relative_sigma / factor;
  e.detail = fmt::format(
      "translations in rig.yaml are {:.4g} times as long as the cameras stand apart: in {}?",
      1.0 / factor, unit.name);
  e.remedy = "Write the translations of rig.yaml in metres.";
  rig.evaluate(h, scaled(rig.stated(), 1.0 / unit.per_metre));
  return h;
}

RigHypothesis size_hypothesis(const RigCase& rig, double factor, double relative_sigma) {
  RigHypothesis h = rig.hypothesis();
  h.numbers = 1;
  RigExplanation& e = h.explanation;
  e.cause = Cause::size_scale;
  e.cameras = rig.all_but_first();
  e.value = 100.0 * (factor - 1.0);
  e.sigma = 100.0 * relative_sigma * factor;
  e.unit = "%";
  e.detail = sizes_against_baselines({factor, relative_sigma * factor});
  e.remedy = kMeasureSizes;
  rig.evaluate(h, scaled(rig.stated(), factor));
  return h;
}

}  // namespace

RigHypothesis rig_scale_hypothesis(const RigCase& rig) {
  const LeastCost fitted = fitted_factor(rig);
  const double factor = std::exp(fitted.at);
  if (const auto unit = unit_of(1.0 / factor)) {
    return unit_hypothesis(rig, *unit, factor, fitted.sigma);
  }
  return size_hypothesis(rig, factor, fitted.sigma);
}

}  // namespace waymark
