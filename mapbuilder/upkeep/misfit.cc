#include "mapbuilder/upkeep/misfit.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/median.h"

namespace waymark {
namespace {

constexpr double kShiftedSigmas = 5.0;
constexpr std::size_t kFewestForMisfit = 5;

std::optional<double> sigmas_off(const ComparedMarker& marker) {
  if (!marker.sigma_m || !(*marker.sigma_m > 0)) return std::nullopt;
  return marker.distance_m / *marker.sigma_m;
}

}  // namespace

double misfit_sigmas(const std::vector<ComparedMarker>& stayed) {
  std::vector<double> squares;
  for (const ComparedMarker& marker : stayed) {
    if (const auto off = sigmas_off(marker)) squares.push_back(*off * *off);
  }
  if (squares.size() < kFewestForMisfit) return 1.0;
  return std::max(1.0, std::sqrt(median(squares) / kMedianOfChi2_3));
}

bool is_shifted(const ComparedMarker& marker, double misfit) {
  const auto off = sigmas_off(marker);
  return off && *off > kShiftedSigmas * misfit;
}

void acquit(FrameComparison& comparison, double misfit) {
  const auto acquitted = [&](const ComparedMarker& marker) {
    return sigmas_off(marker) && !is_shifted(marker, misfit) &&
           marker.turn_rad <= MovedLimits{}.turn_rad;
  };
  std::copy_if(comparison.moved.begin(), comparison.moved.end(),
               std::back_inserter(comparison.stayed), acquitted);
  std::erase_if(comparison.moved, acquitted);
  std::sort(comparison.stayed.begin(), comparison.stayed.end(),
            [](const ComparedMarker& a, const ComparedMarker& b) { return a.id < b.id; });
}

}  // namespace waymark
