#include "mapbuilder/diagnosis/misshapen_markers.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "mapbuilder/diagnosis/scatter.h"
#include "mapbuilder/diagnosis/view_placement.h"

namespace waymark {
namespace {

struct ShapeFit {
  MarkerIndex marker;
  PrintFit fit;
};

std::optional<PrintFit> fit_shape(std::span<const MarkerView> views, const PrintedPose& start,
                                  const MapEvidence& evidence) {
  return fit_print(views, start, FreePrint::size_and_stretch, evidence.options().loss);
}

Measured stretch_of(const PrintFit& fit) { return {fit.place.stretch, fit.stretch_sigma}; }

/// Where the map has the marker, or where its views have it.
std::optional<Rigid3> start_of(std::span<const MarkerView> views, MarkerIndex marker,
                               const MapEvidence& evidence) {
  if (const auto& place = evidence.place(marker)) return place->world_from_marker;
  const auto placed = place_at_size(views, 1.0, evidence.options());
  return placed ? std::optional(placed->best.pose) : std::nullopt;
}

/// Of every marker with views enough, by rising index.
std::vector<ShapeFit> fit_shapes(const MapEvidence& evidence, std::size_t least_views) {
  constexpr std::size_t kScreeningViews = 32;
  const std::vector<MarkerIndex>& markers = evidence.markers();
  std::vector<std::optional<ShapeFit>> found(markers.size());
  parallel_for(markers.size(), evidence.options().threads, [&](std::size_t m) {
    const auto views = thinned(evidence.views_of(markers[m], 2), kScreeningViews);
    if (views.size() < least_views) return;
    const auto start = start_of(views, markers[m], evidence);
    const auto fit = start ? fit_shape(views, {*start}, evidence) : std::nullopt;
    if (fit) found[m] = ShapeFit{markers[m], *fit};
  });
  std::vector<ShapeFit> fits;
  for (const auto& one : found) {
    if (one) fits.push_back(*one);
  }
  return fits;
}

/// Whether the shape takes two fifths of what the views leave of a square, whatever its size: a
/// lens or a rig that misfits bends markers, too, but each view otherwise.
bool is_explained_by_shape(std::span<const MarkerView> views, const PrintFit& shape,
                           const MapEvidence& evidence) {
  constexpr double kExplains = 0.6;
  PrintedPose square = shape.place;
  square.stretch = 0;
  const auto fit = fit_print(views, square, FreePrint::size, evidence.options().loss);
  return fit && shape.cost < kExplains * fit->cost;
}

}  // namespace

std::vector<MisshapenMarker> find_misshapen_markers(const MapEvidence& evidence,
                                                    const OddPrintOptions& options) {
  constexpr std::size_t kFitViews = 64;
  const auto least_views = static_cast<std::size_t>(options.least_views);
  const std::vector<ShapeFit> shapes = fit_shapes(evidence, least_views);
  std::vector<MisshapenMarker> misshapen;
  if (shapes.size() < static_cast<std::size_t>(options.least_markers) + 1) return misshapen;
  std::vector<Measured> stretches;
  for (const ShapeFit& shape : shapes) stretches.push_back(stretch_of(shape.fit));
  const Scatter scatter = scatter_of(stretches);
  const auto stands_out = [&](const PrintFit& fit) {
    return std::abs(fit.place.stretch - scatter.centre) > options.least_stretch &&
           scatter.excludes(stretch_of(fit), options.least_sigmas);
  };
  for (const ShapeFit& suspect : shapes) {
    if (!stands_out(suspect.fit)) continue;
    const auto views = thinned(evidence.independent_views_of(suspect.marker, 2), kFitViews);
    if (views.size() < least_views) continue;
    const auto fit = fit_shape(views, suspect.fit.place, evidence);
    if (!fit || !stands_out(*fit) || views_that_fit(views, fit->place, evidence).empty() ||
        !is_explained_by_shape(views, *fit, evidence)) {
      continue;
    }
    misshapen.push_back({suspect.marker, fit->place.stretch - scatter.centre,
                         std::hypot(fit->stretch_sigma, scatter.spread), views.size(),
                         shapes.size() - 1});
  }
  return misshapen;
}

}  // namespace waymark
