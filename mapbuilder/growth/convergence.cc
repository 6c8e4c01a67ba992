// IncrementalMapper::converge: how a grown map comes to rest.
#include <algorithm>

#include "mapbuilder/growth/adjustment_stages.h"
#include "mapbuilder/growth/incremental_mapper.h"

namespace waymark {
namespace {

/// A relative change of the noise model below which it is at rest.
constexpr double kNoiseAtRest = 0.02;

/// Adjustments of exactly the observations that the last gate accepts.
constexpr int kMostPolishes = 5;

NoiseFittedEstimate fit_all_noise(const IncrementalMapper& mapper, const AdjustedSystem& system,
                                  Estimate estimate) {
  NoiseFittedEstimate all{std::move(estimate), 0.0};
  for (const ComponentIndex c : system.components) {
    NoiseFittedEstimate one = mapper.fit_noise(c, std::move(all.estimate));
    all = {std::move(one.estimate), std::max(all.change, one.change)};
  }
  return all;
}

ReconsideredEstimate reconsider_all(const IncrementalMapper& mapper, const AdjustedSystem& system,
                                    Estimate estimate) {
  ReconsideredEstimate all{std::move(estimate), 0};
  for (const ComponentIndex c : system.components) {
    ReconsideredEstimate one = mapper.reconsider(c, std::move(all.estimate));
    all = {std::move(one.estimate), all.moved + one.moved};
  }
  return all;
}

}  // namespace

ConvergedEstimate IncrementalMapper::converge(const AdjustedSystem& system, Estimate estimate,
                                              Progress& progress) const {
  ConvergedEstimate result;
  const auto adjusted = [&](const BundleOptions& options, Estimate from) {
    BundleSolution solution = adjust(system, options, std::move(from));
    if (solution.uncertainty) result.uncertainty = std::move(solution.uncertainty);
    return solution;
  };
  progress.begin("adjusting jointly", static_cast<std::size_t>(options_.max_passes));
  estimate = fit_all_noise(*this, system, std::move(estimate)).estimate;
  for (int pass = 0; pass < options_.max_passes; ++pass) {
    // Whether it has converged is asked of the polish alone.
    estimate = adjusted(pass_adjustment(options_), std::move(estimate)).estimate;
    NoiseFittedEstimate fitted = fit_all_noise(*this, system, std::move(estimate));
    ReconsideredEstimate reconsidered = reconsider_all(*this, system, std::move(fitted.estimate));
    GatedEstimate gated = gate(system.components, std::move(reconsidered.estimate));
    estimate = std::move(gated.estimate);
    progress.update(
        static_cast<std::size_t>(pass) + 1,
        fmt::format("model sigma {:.3f} px",
                    estimate.components[system.components.front()].noise.model_sigma_px));
    if (reconsidered.moved + gated.changed == 0 && fitted.change < kNoiseAtRest) break;
  }
  bool at_rest = false;
  for (int polish = 0; polish < kMostPolishes && !at_rest; ++polish) {
    BundleSolution solution = adjusted(polish_adjustment(options_), std::move(estimate));
    estimate = std::move(solution.estimate);
    if (!solution.summary.at_optimum()) continue;
    GatedEstimate gated = gate(system.components, std::move(estimate));
    estimate = std::move(gated.estimate);
    at_rest = gated.changed == 0;
  }
  for (const ComponentIndex c : system.components) estimate.components[c].converged = at_rest;
  progress.end();
  result.estimate = std::move(estimate);
  return result;
}

}  // namespace waymark
