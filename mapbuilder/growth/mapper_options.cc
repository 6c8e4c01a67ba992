#include "mapbuilder/growth/mapper_options.h"

#include "core/base/parallel.h"
#include "core/base/range.h"

namespace waymark {

Status GrowthOptions::check() const {
  return RangeCheck()
      .part("rig_pose", rig_pose.check())
      .part("placement", placement.check())
      .field("placement_gap", placement_gap, {0.0, 1000.0})
      .field("firm_markers", firm_markers, {1, 10})
      .field("max_placement_views", max_placement_views, {2, 1000})
      .field("adjust_growth", adjust_growth, {1.05, 10.0})
      .field("explained_sigmas2", explained_sigmas2, {8.0, 100.0})
      .field("give_up_sigma_px", give_up_sigma_px, {1.0, kLargestModelSigma})
      .status();
}

Status MapperOptions::check() const {
  return RangeCheck()
      .part("noise", noise.check())
      .part("loss", loss.check())
      .part("gate", gate.check())
      .part("growth", growth.check())
      .field("max_passes", max_passes, {1, 50})
      .field("threads", threads, kThreads)
      .status();
}

MapperOptions effective(MapperOptions options) {
  options.growth.rig_pose.loss = options.loss;
  options.growth.placement.loss = options.loss;
  options.threads = effective_threads(options.threads);
  return options;
}

}  // namespace waymark
