#include "mapbuilder/upkeep/joined_system.h"

#include <algorithm>
#include <iterator>

#include "core/geometry/alignment.h"
#include "core/geometry/decompositions.h"
#include "mapbuilder/bundle/block_cholesky.h"
#include "mapbuilder/bundle/marker_covariances.h"
#include "mapbuilder/observations/covisibility.h"

namespace waymark {
namespace {

/// Those of the observations that hang together with one of the markers.
std::vector<ObservationIndex> tied(const Observations& observations,
                                   const std::vector<ObservationIndex>& counting,
                                   const std::vector<MarkerIndex>& by) {
  std::set<MarkerIndex> markers;
  for (const Component& component : connected_components(observations, counting)) {
    const bool has_one = std::any_of(by.begin(), by.end(), [&](MarkerIndex m) {
      return std::binary_search(component.markers.begin(), component.markers.end(), m);
    });
    if (has_one) markers.insert(component.markers.begin(), component.markers.end());
  }
  std::vector<ObservationIndex> result;
  for (const ObservationIndex index : counting) {
    if (markers.contains(observations[index].marker)) result.push_back(index);
  }
  return result;
}

int slot_of(const std::vector<MarkerId>& ids, const MarkerId& id) {
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  return at != ids.end() && *at == id ? static_cast<int>(at - ids.begin()) : -1;
}

/// Adds a system's blocks to another's, whose markers include its own in the same order.
void add_blocks(const KnownMarkers& from, KnownMarkers& to) {
  for (const auto& [at, block] : from.system.blocks) {
    const int row = slot_of(to.ids, from.ids[static_cast<std::size_t>(at.first)]);
    const int column = slot_of(to.ids, from.ids[static_cast<std::size_t>(at.second)]);
    to.system.blocks.try_emplace({row, column}, Matrix6d::Zero()).first->second += block;
  }
}

/// N x.
Eigen::VectorXd times(const MarkerSystem& system, const Eigen::VectorXd& x) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  for (const auto& [at, block] : system.blocks) {
    y.segment<6>(6L * at.first) += block * x.segment<6>(6L * at.second);
    if (at.first != at.second) {
      y.segment<6>(6L * at.second) += block.transpose() * x.segment<6>(6L * at.first);
    }
  }
  return y;
}

/// Takes the mean motion of some markers out of a step of all.
void remove_mean_motion(const std::vector<Rigid3>& places, const std::vector<int>& of,
                        Eigen::VectorXd& step) {
  std::vector<Eigen::Vector3d> positions;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const int i : of) {
    positions.push_back(places[static_cast<std::size_t>(i)].translation);
    centre += positions.back() / static_cast<double>(of.size());
  }
  const bool by_position = of.size() >= 3 && !lie_on_a_line(positions);
  const auto motion_of = [&](int i) {
    Matrix6d motion = Matrix6d::Identity();
    motion.topRightCorner<3, 3>() = -skew(places[static_cast<std::size_t>(i)].translation - centre);
    return motion;
  };
  const auto gauge_of = [&](int i) {
    Matrix6d gauge = motion_of(i);
    if (by_position) gauge.bottomRows<3>().setZero();
    return gauge;
  };
  Matrix6d normal = Matrix6d::Zero();
  Vector6d mean = Vector6d::Zero();
  for (const int i : of) {
    const Matrix6d gauge = gauge_of(i);
    normal += gauge.transpose() * motion_of(i);
    mean += gauge.transpose() * step.segment<6>(6L * i);
  }
  const Vector6d motion = inverse(normal) * mean;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const int at = static_cast<int>(i);
    step.segment<6>(6L * at) -= motion_of(at) * motion;
  }
}

/// The marker of which most is known.
int best_known(const MarkerSystem& system) {
  int best = 0;
  for (int i = 1; i < system.markers(); ++i) {
    const auto trace = [&](int k) { return system.blocks.at({k, k}).diagonal().head<3>().sum(); };
    if (trace(i) > trace(best)) best = i;
  }
  return best;
}

std::vector<Matrix6d> covariances_of(const MarkerSystem& system) {
  MarkerInformation information;
  information.markers.resize(system.world_from_marker.size());
  information.world_from_marker = system.world_from_marker;
  information.information = block_matrix_of(system);
  if (!system.world_is_fixed) return marker_covariances(information);
  BlockCholesky cholesky(information.information.pattern);
  if (!cholesky.factorize(information.information)) return {};
  std::vector<Matrix6d> covariances = cholesky.inverse_diagonal();
  for (Matrix6d& c : covariances) c = 0.5 * (c + c.transpose()).eval();
  return covariances;
}

/// The markers of both, at the places of the first that has them.
KnownMarkers markers_of_both(const KnownMarkers& earlier, const KnownMarkers& round) {
  KnownMarkers both;
  std::set_union(earlier.ids.begin(), earlier.ids.end(), round.ids.begin(), round.ids.end(),
                 std::back_inserter(both.ids));
  for (const MarkerId& id : both.ids) {
    const int known = slot_of(earlier.ids, id);
    both.system.world_from_marker.push_back(
        known >= 0
            ? earlier.system.world_from_marker[static_cast<std::size_t>(known)]
            : round.system.world_from_marker[static_cast<std::size_t>(slot_of(round.ids, id))]);
  }
  both.system.world_is_fixed = earlier.system.world_is_fixed;
  return both;
}

}  // namespace

KnownMarkers KnownMarkers::marginal(const std::set<MarkerId>& keep) const {
  std::vector<int> kept;
  KnownMarkers result;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!keep.contains(ids[i])) continue;
    kept.push_back(static_cast<int>(i));
    result.ids.push_back(ids[i]);
  }
  result.system = marginal_system(system, kept);
  return result;
}

KnownMarkers known_by_round(const RoundParts& round, const RoundPart& part,
                            const Rigid3& world_from_round, const std::vector<MarkerId>& tied_by) {
  const Observations& observations = round.observations();
  const Component& component = round.component_of(part);
  Estimate estimate = round.estimate();
  move_poses(component, world_from_round * part.world_from_estimate, estimate);
  BundleProblem problem;
  problem.prepared = &round.prepared();
  problem.observations = round.selection().used_in(component.frame_sets);
  problem.loss = round.options().loss;
  std::vector<ObservationIndex> counting = counting_observations(problem, estimate);
  if (!tied_by.empty()) {
    std::vector<MarkerIndex> by;
    for (const MarkerId& id : tied_by) {
      if (const auto m = round.index_of(id)) by.push_back(*m);
    }
    counting = tied(observations, counting, by);
  }
  KnownMarkers known;
  if (counting.empty()) return known;
  ReducedProblem reduced(problem, counting, {}, estimate, round.options().threads);
  const BlockMatrix information = reduced.reduce(reduced.start(), 0.0).information;
  // Markers are numbered by rising index, and so by rising id.
  for (const MarkerIndex m : reduced.markers()) known.ids.push_back(observations.markers[m]);
  known.system.world_from_marker = reduced.start().world_from_marker;
  for (int column = 0; column < information.pattern.columns(); ++column) {
    const auto c = static_cast<std::size_t>(column);
    for (int b = information.pattern.first[c]; b < information.pattern.first[c + 1]; ++b) {
      const auto at = static_cast<std::size_t>(b);
      known.system.blocks[{information.pattern.rows[at], column}] = information.blocks[at];
    }
  }
  return known;
}

std::vector<MarkerSystem> systems_of_build(const RoundParts& build) {
  std::vector<MarkerSystem> systems(build.result().submaps.size());
  for (const RoundPart& part : build.parts()) {
    KnownMarkers known = known_by_round(build, part, {}, {});
    if (known.ids.size() != build.submap_of(part).markers.size()) continue;
    systems[part.submap] = std::move(known.system);
  }
  return systems;
}

JoinedMarkers join(const KnownMarkers& earlier, const KnownMarkers& round) {
  JoinedMarkers joined{markers_of_both(earlier, round), {}};
  MarkerSystem& system = joined.known.system;
  // How far the round's places lie from those taken.
  KnownMarkers of_round{joined.known.ids, {system.world_from_marker, {}, false}};
  add_blocks(round, of_round);
  Eigen::VectorXd apart = Eigen::VectorXd::Zero(6L * system.markers());
  for (std::size_t i = 0; i < round.ids.size(); ++i) {
    const int at = slot_of(joined.known.ids, round.ids[i]);
    apart.segment<6>(6L * at) = round.system.world_from_marker[i].minus(
        system.world_from_marker[static_cast<std::size_t>(at)]);
  }
  Eigen::VectorXd right = times(of_round.system, apart);
  add_blocks(earlier, joined.known);
  add_blocks(round, joined.known);

  BlockMatrix matrix = block_matrix_of(system);
  if (!system.world_is_fixed) {
    const int anchor = best_known(system);
    fix_block(matrix, anchor);
    right.segment<6>(6L * anchor).setZero();
  }
  BlockCholesky cholesky(matrix.pattern);
  if (!cholesky.factorize(matrix)) return joined;
  Eigen::VectorXd step = cholesky.solve(right);
  if (!system.world_is_fixed) {
    std::vector<int> of_earlier;
    for (const MarkerId& id : earlier.ids) of_earlier.push_back(slot_of(joined.known.ids, id));
    remove_mean_motion(system.world_from_marker, of_earlier, step);
  }
  for (int i = 0; i < system.markers(); ++i) {
    Rigid3& place = system.world_from_marker[static_cast<std::size_t>(i)];
    place = place.plus(step.segment<6>(6L * i));
  }
  joined.covariances = covariances_of(system);
  return joined;
}

}  // namespace waymark
