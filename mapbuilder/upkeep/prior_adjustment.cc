#include "mapbuilder/upkeep/prior_adjustment.h"

#include <algorithm>
#include <set>

#include "mapbuilder/bundle/block_cholesky.h"
#include "mapbuilder/bundle/schur_adjuster.h"
#include "mapbuilder/growth/adjustment_stages.h"
#include "mapbuilder/observations/covisibility.h"
#include "mapbuilder/upkeep/marker_prior.h"

namespace waymark {
namespace {

/// Those of the observations that hang together with a known marker: a piece that the earlier map
/// says nothing of stands nowhere.
std::vector<ObservationIndex> tied(const Observations& observations,
                                   const std::vector<ObservationIndex>& counting,
                                   const std::vector<MarkerIndex>& known) {
  std::set<MarkerIndex> markers;
  for (const Component& component : connected_components(observations, counting)) {
    const bool has_known = std::any_of(known.begin(), known.end(), [&](MarkerIndex m) {
      return std::binary_search(component.markers.begin(), component.markers.end(), m);
    });
    if (has_known) markers.insert(component.markers.begin(), component.markers.end());
  }
  std::vector<ObservationIndex> result;
  for (const ObservationIndex index : counting) {
    if (markers.contains(observations[index].marker)) result.push_back(index);
  }
  return result;
}

}  // namespace

std::map<MarkerId, AdjustedPlace> adjust_with_priors(const RoundParts& round, const RoundPart& part,
                                                     const Rigid3& old_from_round,
                                                     const std::vector<const MapMarker*>& known) {
  const Observations& observations = round.observations();
  const Component& component = round.component_of(part);
  Estimate estimate = round.estimate();
  move_poses(component, old_from_round * part.world_from_estimate, estimate);
  std::vector<MarkerIndex> known_indices;
  for (const MapMarker* marker : known) {
    if (const auto m = round.index_of(marker->id)) known_indices.push_back(*m);
  }
  BundleProblem problem;
  problem.prepared = &round.prepared();
  problem.observations = round.selection().used_in(component.frame_sets);
  problem.loss = round.options().loss;
  const auto counting = tied(observations, counting_observations(problem, estimate), known_indices);
  if (counting.empty()) return {};
  ReducedProblem reduced(problem, counting, {}, estimate, round.options().threads);
  for (const MapMarker* marker : known) {
    const auto m = round.index_of(marker->id);
    const auto block = m ? reduced.block_of(*m) : std::nullopt;
    if (!block) continue;
    reduced.add(
        std::make_unique<MarkerPrior>(*block, marker->world_from_marker, marker->covariance));
  }
  BundleSummary summary;
  const BundleVariables optimum =
      minimize_reduced(reduced, polish_adjustment(round.options()), summary);
  const BlockMatrix information = reduced.reduce(optimum, 0.0).information;
  BlockCholesky cholesky(information.pattern);
  if (!cholesky.factorize(information)) return {};
  const std::vector<Matrix6d> covariances = cholesky.inverse_diagonal();
  std::map<MarkerId, AdjustedPlace> places;
  for (std::size_t k = 0; k < reduced.markers().size(); ++k) {
    const Matrix6d& c = covariances[k];
    places[observations.markers[reduced.markers()[k]]] = {optimum.world_from_marker[k],
                                                          0.5 * (c + c.transpose())};
  }
  return places;
}

}  // namespace waymark
