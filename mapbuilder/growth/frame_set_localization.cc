#include "mapbuilder/growth/frame_set_localization.h"

#include "core/base/parallel.h"

namespace waymark {
namespace {

/// One rig pose solver per rig: a worker thread's tools.
IndexedVector<RigIndex, RigPoseSolver> solvers_for(const Calibration& calibration,
                                                   const RigPoseOptions& options) {
  std::vector<RigPoseSolver> solvers;
  solvers.reserve(calibration.rigs.size());
  for (const Rig& rig : calibration.rigs) solvers.emplace_back(rig, options);
  return IndexedVector<RigIndex, RigPoseSolver>(std::move(solvers));
}

std::vector<FixedMarkerObservation> mapped_observations(const PreparedObservations& prepared,
                                                        const Estimate& estimate,
                                                        FrameSetIndex frame_set) {
  const auto collect = [&](bool accepted_only) {
    std::vector<FixedMarkerObservation> observations;
    for (const ObservationIndex index : prepared.selection().used_in(frame_set)) {
      const auto& world_from_marker =
          estimate.world_from_marker[prepared.observations()[index].marker];
      if (!world_from_marker || (accepted_only && !estimate.accepts(index))) continue;
      observations.push_back({&prepared[index], *world_from_marker});
    }
    return observations;
  };
  auto observations = collect(true);
  return observations.empty() ? collect(false) : observations;
}

std::optional<RigPoseEstimate> solve_afresh(RigPoseSolver& solver,
                                            std::span<const FixedMarkerObservation> observations,
                                            const std::optional<RigPoseEstimate>& known,
                                            double explained_sigmas2) {
  if (!known) return solver.solve(observations);
  const auto here = solver.refine(observations, known->best.pose);
  const double most = explained_sigmas2 * static_cast<double>(observations.size());
  if (here && !known->ambiguous && here->cost <= most) {
    // Nothing is left to explain: no other pose can be better by more than this cost.
    RigPoseEstimate same = *known;
    same.best = *here;
    return same;
  }
  return solver.solve(observations, {&known->best.pose, 1});
}

}  // namespace

std::vector<std::optional<RigPoseEstimate>> solve_frame_sets(
    const PreparedObservations& prepared, const Estimate& estimate,
    std::span<const FrameSetIndex> frame_sets, const MapperOptions& options) {
  std::vector<std::optional<RigPoseEstimate>> found(frame_sets.size());
  parallel_for_with(
      frame_sets.size(), options.threads,
      [&] { return solvers_for(estimate.calibration, options.growth.rig_pose); },
      [&](IndexedVector<RigIndex, RigPoseSolver>& solvers, std::size_t i) {
        const auto observations = mapped_observations(prepared, estimate, frame_sets[i]);
        if (observations.empty()) return;
        RigPoseSolver& solver = solvers[prepared.observations().frame_sets[frame_sets[i]].rig];
        found[i] = solve_afresh(solver, observations, estimate.world_from_rig[frame_sets[i]],
                                options.growth.explained_sigmas2);
      });
  return found;
}

Estimate localize(const PreparedObservations& prepared, std::span<const FrameSetIndex> frame_sets,
                  const MapperOptions& options, Estimate estimate) {
  auto found = solve_frame_sets(prepared, estimate, frame_sets, options);
  for (std::size_t i = 0; i < frame_sets.size(); ++i) {
    estimate.world_from_rig[frame_sets[i]] = std::move(found[i]);
  }
  return estimate;
}

std::vector<FrameSetIndex> unadjusted_frame_sets(const Selection& selection,
                                                 std::span<const FrameSetIndex> frame_sets,
                                                 const Estimate& estimate) {
  std::vector<FrameSetIndex> left_out;
  for (const FrameSetIndex frame_set : frame_sets) {
    int accepted = 0;
    for (const ObservationIndex index : selection.used_in(frame_set)) {
      accepted += estimate.accepts(index) && estimate.posed(selection[index]) ? 1 : 0;
    }
    if (accepted < 2) left_out.push_back(frame_set);
  }
  return left_out;
}

}  // namespace waymark
