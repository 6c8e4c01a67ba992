#include "mapbuilder/growth/joint_build.h"

#include <algorithm>

#include "core/base/parallel.h"

namespace waymark {

JointBuild::JointBuild(ObservationTable& table, std::vector<ComponentGrowth*> parts,
                       const BuildOptions& options, Progress& progress, MapState& state)
    : table_(table),
      parts_(std::move(parts)),
      options_(options),
      progress_(progress),
      state_(state),
      threads_(effective_threads(options.threads)) {
  for (const ComponentGrowth* part : parts_) {
    observations_.insert(observations_.end(), part->observations().begin(),
                         part->observations().end());
  }
  set_scope({});
}

void JointBuild::set_scope(AdjustmentScope scope) {
  scope_ = std::move(scope);
  held_.frame_sets.clear();
  for (const ComponentGrowth* part : parts_) {
    if (!scope_.in_facility(part->component().markers.front())) {
      held_.frame_sets.push_back(part->anchor());
    }
  }
}

AdjustmentSummary JointBuild::adjust(const AdjustmentOptions& options) {
  AdjustmentOptions scoped = options;
  scoped.scope = scope_;
  const AdjustmentSummary summary = adjust_jointly(table_, observations_, held_, scoped, state_);
  if (summary.uncertainty) uncertainty_ = *summary.uncertainty;
  for (const ComponentGrowth* part : parts_) part->follow(state_);
  return summary;
}

double JointBuild::adapt_noise() {
  double change = 0;
  for (ComponentGrowth* part : parts_) change = std::max(change, part->adapt_noise(state_));
  return change;
}

void JointBuild::settle() {
  constexpr double kNoiseSettled = 0.02;
  bool settled = false;
  progress_.begin("adjusting jointly", static_cast<std::size_t>(options_.max_passes));
  adapt_noise();
  for (int pass = 0; pass < options_.max_passes; ++pass) {
    adjust({options_.loss, 30, 1e-4, 1e-8, threads_, {}});
    const double noise_change = adapt_noise();
    std::size_t reconsidered = 0;
    for (const ComponentGrowth* part : parts_) reconsidered += part->reconsider(state_);
    const std::size_t gated = update_gate(table_, observations_, options_.gate, state_);
    progress_.update(static_cast<std::size_t>(pass) + 1,
                     fmt::format("model sigma {:.3f} px", parts_.front()->noise().model_sigma_px));
    if (reconsidered + gated == 0 && noise_change < kNoiseSettled) break;
  }
  // The last adjustment is one of exactly the observations that the last gate accepts.
  constexpr int kMostPolishes = 5;
  for (int polish = 0; polish < kMostPolishes && !settled; ++polish) {
    const AdjustmentSummary summary = adjust({options_.loss, 50, 1e-9, 1e-14, threads_, {}});
    const bool converged = summary.converged || summary.observations == 0;
    settled = converged && update_gate(table_, observations_, options_.gate, state_) == 0;
  }
  for (ComponentGrowth* part : parts_) part->set_settled(settled);
  progress_.end();
}

}  // namespace waymark
