#include "mapbuilder/bundle/bundle_problem.h"

#include <map>

#include "core/base/range.h"

namespace waymark {

Status check(const BundleOptions& options) {
  return RangeCheck()
      .field("max_iterations", options.max_iterations, {1, 1000})
      .field("function_tolerance", options.function_tolerance, {1e-16, 0.1})
      .field("initial_damping", options.initial_damping, {1e-16, 1.0})
      .field("threads", options.threads, {1, 1024})
      .status();
}

std::vector<ObservationIndex> counting_observations(const BundleProblem& problem,
                                                    const Estimate& estimate) {
  const Observations& all = problem.prepared->observations();
  std::vector<ObservationIndex> counting;
  std::map<FrameSetIndex, int> per_set;
  for (const ObservationIndex index : problem.observations) {
    const Observation& o = all[index];
    if (!estimate.accepts(index) || !estimate.posed(o)) continue;
    const CameraModel& camera = estimate.calibration.camera(all, o).model;
    const auto residuals =
        corner_residuals((*problem.prepared)[index], camera, cam_from_marker(all, estimate, o));
    if (!residuals || std::any_of(residuals->begin(), residuals->end(), [&](const auto& r) {
          return r.norm() > gross_residual_px(camera);
        })) {
      continue;
    }
    counting.push_back(index);
    ++per_set[o.frame_set];
  }
  std::erase_if(counting,
                [&](ObservationIndex index) { return per_set[all[index].frame_set] < 2; });
  return counting;
}

}  // namespace waymark
