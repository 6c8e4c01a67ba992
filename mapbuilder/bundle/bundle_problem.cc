#include "mapbuilder/bundle/bundle_problem.h"

#include <map>

#include "core/base/parallel.h"
#include "core/base/range.h"

namespace waymark {

Status BundleScope::check() const {
  return RangeCheck()
      .field("size_sigma", size_sigma, {1e-4, 0.1})
      .field("edge_bias_sigma_px", edge_bias_sigma_px, {0.01, 2})
      .status();
}

Status BundleOptions::check() const {
  return RangeCheck()
      .field("max_iterations", max_iterations, {1, 1000})
      .field("function_tolerance", function_tolerance, {1e-16, 0.1})
      .field("initial_damping", initial_damping, {1e-16, 1.0})
      .field("threads", threads, {1, kThreads.high})
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
