#include "mapbuilder/diagnosis/wrong_sizes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"
#include "mapbuilder/diagnosis/scatter.h"
#include "mapbuilder/diagnosis/view_placement.h"

namespace waymark {
namespace {

struct Deviation {
  MarkerIndex marker;
  Measured log_factor;
};

/// Logarithm of a fitted size over the stated one.
Measured deviation_of(const MapEvidence& evidence, MarkerIndex marker, const PrintFit& fit) {
  return {std::log(fit.place.factor * evidence.size_m(marker) / evidence.stated_size_m(marker)),
          fit.factor_sigma};
}

std::optional<PrintFit> fit_size(std::span<const MarkerView> views, const PrintedPose& start,
                                 const MapEvidence& evidence) {
  return fit_print(views, start, FreePrint::size, evidence.options().loss);
}

/// The best fit over starts that are far too small to far too large.
std::optional<PrintFit> fit_from_afar(std::span<const MarkerView> views,
                                      const MapEvidence& evidence) {
  constexpr std::array<double, 5> kFactors{1.0, 0.85, 1.18, 0.7, 1.4};
  std::optional<PrintFit> best;
  for (const double factor : kFactors) {
    const auto placed = place_at_size(views, factor, evidence.options());
    if (!placed) continue;
    const auto fit = fit_size(views, {placed->best.pose, factor}, evidence);
    if (fit && (!best || fit->cost < best->cost)) best = fit;
  }
  return best;
}

}  // namespace

std::vector<WrongSize> find_wrong_sizes(const MapEvidence& evidence,
                                        const OddPrintOptions& options) {
  constexpr std::size_t kScreeningViews = 32;
  constexpr std::size_t kFitViews = 64;
  const auto least_views = static_cast<std::size_t>(options.least_views);
  const std::vector<MarkerIndex>& markers = evidence.markers();
  std::vector<std::optional<Deviation>> found(markers.size());
  parallel_for(markers.size(), evidence.options().threads, [&](std::size_t m) {
    const MarkerIndex marker = markers[m];
    auto views = thinned(evidence.views_of(marker, 2), kScreeningViews);
    if (views.size() < least_views) return;
    std::optional<PrintFit> fit;
    if (const auto& place = evidence.place(marker)) {
      fit = fit_size(views, {place->world_from_marker}, evidence);
    } else {
      fit = fit_from_afar(views, evidence);
    }
    if (fit) found[m] = Deviation{marker, deviation_of(evidence, marker, *fit)};
  });
  std::vector<Deviation> deviations;
  for (const auto& deviation : found) {
    if (deviation) deviations.push_back(*deviation);
  }
  std::vector<WrongSize> wrong;
  if (deviations.size() < static_cast<std::size_t>(options.least_markers) + 1) return wrong;
  std::vector<Measured> log_factors;
  for (const Deviation& deviation : deviations) log_factors.push_back(deviation.log_factor);
  const Scatter scatter = scatter_of(log_factors);
  const auto stands_out = [&](const Measured& log_factor, double share) {
    return std::abs(log_factor.value - scatter.centre) > share * options.least_size_deviation &&
           scatter.excludes(log_factor, share * options.least_sigmas);
  };
  for (const Deviation& suspect : deviations) {
    constexpr double kWorthAnotherLook = 0.5;
    if (!stands_out(suspect.log_factor, kWorthAnotherLook)) continue;
    const auto views = thinned(evidence.independent_views_of(suspect.marker, 2), kFitViews);
    if (views.size() < least_views) continue;
    auto fit = fit_from_afar(views, evidence);
    if (!fit) continue;
    const auto fitting = views_that_fit(views, fit->place, evidence);
    if (fitting.empty()) continue;
    fit = fit_size(fitting, fit->place, evidence);
    if (!fit || !stands_out(deviation_of(evidence, suspect.marker, *fit), 1.0)) {
      continue;
    }
    const double fitted_m = evidence.size_m(suspect.marker) * fit->place.factor;
    wrong.push_back({suspect.marker, evidence.stated_size_m(suspect.marker), fitted_m,
                     fitted_m * std::hypot(fit->factor_sigma, scatter.spread), scatter.spread,
                     fitting.size(), deviations.size() - 1});
  }
  return wrong;
}

}  // namespace waymark
