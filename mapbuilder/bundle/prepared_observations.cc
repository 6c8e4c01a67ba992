#include "mapbuilder/bundle/prepared_observations.h"

#include <algorithm>

#include "core/base/parallel.h"
#include "core/estimate/ippe.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

bool are_alike(const Rigid3& a, const Rigid3& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

bool are_alike(const Rig& a, const Rig& b) {
  return std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
                    [](const RigCamera& one, const RigCamera& other) {
                      return one.model.parameters() == other.model.parameters() &&
                             are_alike(one.rig_from_cam, other.rig_from_cam);
                    });
}

bool are_alike(const Calibration& a, const Calibration& b) {
  return a.sizes_m == b.sizes_m && a.edge_bias_steps_px == b.edge_bias_steps_px &&
         std::equal(a.rigs.begin(), a.rigs.end(), b.rigs.begin(), b.rigs.end(),
                    [](const Rig& one, const Rig& other) { return are_alike(one, other); });
}

bool are_alike(const NoiseModel& a, const NoiseModel& b) {
  // Weighting and the paper's constants are a build's options.
  return a.model_sigma_px == b.model_sigma_px;
}

}  // namespace

PreparedObservations::PreparedObservations(const Selection& selection, const Estimate& estimate,
                                           int threads)
    : selection_(&selection),
      threads_(threads),
      noise_(estimate.components.size()),
      observations_of_(estimate.components.size()),
      prepared_(selection.observations().all.size()) {
  for (const auto indices : {selection.used(), selection.unused()}) {
    for (const ObservationIndex index : indices) {
      const auto component = selection.component_of(selection[index].frame_set);
      if (component) observations_of_[*component].push_back(index);
    }
  }
  take_calibration(estimate.calibration);
  solve_ippe_of_all();
  for (const ComponentIndex c : noise_.indices()) take_noise(c, estimate.components[c].noise);
}

void PreparedObservations::update(const Estimate& estimate, Ippe ippe) {
  const bool calibrated = !are_alike(calibration_, estimate.calibration);
  if (calibrated) take_calibration(estimate.calibration);
  const bool by_paper =
      std::any_of(estimate.components.begin(), estimate.components.end(),
                  [](const ComponentEstimate& c) { return c.noise.weighting == Weighting::paper; });
  if (ippe == Ippe::solved || by_paper) solve_ippe_of_all();
  for (const ComponentIndex c : noise_.indices()) {
    const NoiseModel& noise = estimate.components[c].noise;
    if ((calibrated && by_paper) || !are_alike(noise_[c], noise)) take_noise(c, noise);
  }
}

void PreparedObservations::take_calibration(const Calibration& calibration) {
  calibration_ = calibration;
  ippe_solved_ = false;
  const Observations& all = observations();
  parallel_for(prepared_.size(), threads_, [&](std::size_t i) {
    const Observation& o = all[ObservationIndex(i)];
    MarkerObservation& prepared = prepared_[ObservationIndex(i)];
    prepared.camera = static_cast<int>(all.camera_in_rig(o));
    prepared.corners_px = corrected_corners(o, calibration);
    prepared.size_m = calibration.sizes_m[o.marker];
    prepared.ippe.reset();
  });
}

void PreparedObservations::solve_ippe_of_all() {
  if (ippe_solved_) return;
  ippe_solved_ = true;
  parallel_for(prepared_.size(), threads_, [&](std::size_t i) {
    const Observation& o = observations()[ObservationIndex(i)];
    MarkerObservation& prepared = prepared_[ObservationIndex(i)];
    prepared.ippe = solve_ippe(calibration_.camera(observations(), o).model, prepared.corners_px,
                               prepared.size_m);
  });
}

void PreparedObservations::take_noise(ComponentIndex component, const NoiseModel& noise) {
  noise_[component] = noise;
  const std::vector<ObservationIndex>& indices = observations_of_[component];
  parallel_for(indices.size(), threads_, [&](std::size_t i) {
    MarkerObservation& prepared = prepared_[indices[i]];
    prepared.whitening = whitening_of(observations()[indices[i]], prepared.ippe, noise);
  });
}

}  // namespace waymark
