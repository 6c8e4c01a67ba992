#include "mapbuilder/upkeep/round_parts.h"

#include <algorithm>
#include <set>

#include "core/map/marker_search.h"
#include "mapbuilder/growth/adjustment_stages.h"
#include "mapbuilder/growth/incremental_mapper.h"

namespace waymark {
namespace {

/// Everything that no sub-map rests on is left out.
Corrections without_unmapped(const Observations& observations, const BuildResult& result) {
  std::set<ObservationIndex> mapped;
  for (const BuiltSubMap& submap : result.submaps) {
    for (const ObservationResidual& residual : submap.residuals) {
      if (residual.accepted) mapped.insert(residual.observation);
    }
  }
  Corrections corrections;
  for (std::size_t i = 0; i < observations.usable; ++i) {
    if (!mapped.contains(ObservationIndex(i))) corrections.left_out.insert(ObservationIndex(i));
  }
  return corrections;
}

}  // namespace

RoundParts::RoundParts(const Observations& observations, const BuildResult& result,
                       const MapperOptions& options)
    : result_(result),
      options_(effective(options)),
      selection_(observations, without_unmapped(observations, result)),
      parts_(find_parts()),
      estimate_(estimate_of_parts()),
      prepared_(selection_, estimate_, options_.threads) {
  for (const BuiltSubMap& submap : result.submaps) submaps_.push_back(submap.map);
}

Estimate RoundParts::adjusted_from(const RoundPart& part,
                                   const std::map<MarkerId, Rigid3>& places) const {
  const Rigid3 estimate_from_world = part.world_from_estimate.inverse();
  Estimate estimate = estimate_;
  for (const auto& [id, place] : places) {
    if (const auto m = index_of(id)) estimate.world_from_marker[*m] = estimate_from_world * place;
  }
  const IncrementalMapper mapper(selection_, options_);
  return mapper.adjust({{part.component}, {}}, polish_adjustment(options_), std::move(estimate))
      .estimate;
}

void RoundParts::place(const RoundPart& part, const std::map<MarkerId, Rigid3>& places) {
  estimate_ = adjusted_from(part, places);
  for (MapMarker& marker : submaps_[part.submap].markers) {
    const auto m = index_of(marker.id);
    if (m && estimate_.world_from_marker[*m]) {
      marker.world_from_marker = part.world_from_estimate * *estimate_.world_from_marker[*m];
    }
  }
}

std::optional<MarkerIndex> RoundParts::index_of(const MarkerId& id) const {
  const auto& markers = observations().markers.values();
  const auto at = std::lower_bound(markers.begin(), markers.end(), id);
  if (at == markers.end() || *at != id) return std::nullopt;
  return MarkerIndex(static_cast<std::size_t>(at - markers.begin()));
}

std::vector<RoundPart> RoundParts::find_parts() const {
  std::vector<RoundPart> parts;
  for (std::size_t s = 0; s < result_.submaps.size(); ++s) {
    for (const ObservationResidual& residual : result_.submaps[s].residuals) {
      if (!residual.accepted) continue;
      const Observation& o = selection_[residual.observation];
      const MapMarker* mapped =
          find_marker(result_.submaps[s].map, observations().markers[o.marker]);
      const auto& estimated = result_.estimate.world_from_marker[o.marker];
      const auto component = selection_.component_of(o.frame_set);
      if (mapped == nullptr || !estimated || !component) continue;
      parts.push_back({s, *component, mapped->world_from_marker * estimated->inverse()});
      break;
    }
  }
  return parts;
}

Estimate RoundParts::estimate_of_parts() const {
  Estimate estimate = result_.estimate;
  estimate.accepted.assign(observations().all.size(), 1);
  estimate.components.assign(selection_.components().size(), {options_.noise, true});
  for (const RoundPart& part : parts_) {
    estimate.components[part.component].noise.model_sigma_px =
        result_.submaps[part.submap].model_sigma_px;
  }
  return estimate;
}

}  // namespace waymark
