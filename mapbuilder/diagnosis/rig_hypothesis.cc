#include "mapbuilder/diagnosis/rig_hypothesis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/median.h"

namespace waymark {

std::vector<std::size_t> RigCase::every_camera() const {
  std::vector<std::size_t> all(cameras());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

std::vector<std::size_t> RigCase::all_but_first() const {
  std::vector<std::size_t> all = every_camera();
  all.erase(all.begin());
  return all;
}

std::string RigCase::names_but(std::size_t camera) const {
  std::string text;
  for (std::size_t k = 0; k < cameras(); ++k) {
    if (k != camera) text += (text.empty() ? "" : ", ") + name(k);
  }
  return text;
}

RigHypothesis RigCase::hypothesis() const {
  RigHypothesis h;
  h.tracks = tracks_;
  return h;
}

void RigCase::evaluate(RigHypothesis& h, const Extrinsics& start, FreeCameras free) const {
  constexpr double kWorthFitting = 0.95;
  h.rig = start;
  h.cost = fit_.cost(*h.tracks, start, fit_.all());
  if (h.cost < kWorthFitting * stated_cost_) fit_open(h, start, free);
  h.rig_before = h.rig;
  // What the calibration leaves open stays as stated: only what the hypothesis says is put right.
  h.explanation.rig_from_cam = start;
  for (std::size_t k = 0; k < cameras(); ++k) {
    if (free.holds(k)) h.explanation.rig_from_cam[k] = h.rig[k];
  }
}

void RigCase::fit_open(RigHypothesis& h, const Extrinsics& start, FreeCameras free) const {
  h.rig = fit_.fit(*h.tracks, start, free, fit_.all());
  h.cost = fit_.cost(*h.tracks, h.rig, fit_.all()) + fit_.prior_cost(h.rig, start, free);
}

RigHypothesis RigCase::as_stated() const {
  RigHypothesis h = hypothesis();
  fit_open(h, stated(), FreeCameras::none());
  h.rig_before = h.rig;
  return h;
}

double RigCase::noise_left(const RigHypothesis& h) const {
  std::vector<double> squared;
  for (const std::size_t i : fit_.judged()) {
    const CameraTracks::Instant& instant = h.tracks->instants[i];
    const Extrinsics& rig = i >= h.since ? h.rig : h.rig_before;
    const InstantAgreement agreement = agree(instant, rig, fit_.noise_scale());
    if (agreement.cameras < 2) continue;
    const double share = 1.0 - 1.0 / agreement.cameras;
    for (std::size_t k = 0; k < cameras(); ++k) {
      if (!instant.places[k]) continue;
      squared.push_back(
          squared_misfit(*instant.places[k], *agreement.world_from_rig * rig[k], 1.0) / share);
    }
  }
  if (squared.empty()) return std::numeric_limits<double>::infinity();
  return std::sqrt(upper_median(squared) / kMedianOfChi2_6);
}

}  // namespace waymark
