// Which variable of a ReducedProblem is which block, in the canonical order.
#include <algorithm>
#include <map>
#include <set>

#include "core/base/check.h"
#include "core/camera/lens_kind.h"
#include "core/marker/marker_outline.h"
#include "mapbuilder/bundle/reduced_problem.h"
#include "mapbuilder/bundle/survey_factors.h"

namespace waymark {
namespace {

/// A camera stated without distortion may turn out to have some: radtan with zeros is the same.
CameraModel with_lens(const CameraModel& model) {
  CameraParameters parameters = model.parameters();
  if (parameters.distortion != Distortion::none) return model;
  parameters.distortion = Distortion::radtan;
  const auto bent = CameraModel::create(parameters);
  WAYMARK_CHECK(bent);  // zero coefficients bend nothing
  return *bent;
}

}  // namespace

ReducedProblem::ReducedProblem(const BundleProblem& problem,
                               std::span<const ObservationIndex> observations,
                               const ConstantPoses& constant, const Estimate& estimate, int threads)
    : prepared_(*problem.prepared), scope_(problem.scope), loss_(problem.loss), threads_(threads) {
  number_markers(observations, constant, estimate);
  number_calibration(observations, estimate.calibration);
  number_frame_sets(observations, constant, estimate);
  cut_into_slices();
  take_factors_of_scope(estimate.calibration);
}

void ReducedProblem::number_markers(std::span<const ObservationIndex> observations,
                                    const ConstantPoses& constant, const Estimate& estimate) {
  std::set<std::pair<bool, MarkerIndex>> taking_part;  // (constant, marker): the canonical order
  for (const ObservationIndex index : observations) {
    const MarkerIndex marker = prepared_.observations()[index].marker;
    taking_part.emplace(constant.holds(marker), marker);
  }
  slot_of_.resize(prepared_.observations().markers.size());
  for (const auto& [is_constant, marker] : taking_part) {
    slot_of_[marker] = markers_.size();
    markers_.push_back(marker);
    if (!is_constant) layout_.markers = layout_.blocks = static_cast<int>(markers_.size());
    start_.world_from_marker.push_back(*estimate.world_from_marker[marker]);
  }
}

// A camera or a size that nothing shows is constant: nothing could be said of it.
void ReducedProblem::number_calibration(std::span<const ObservationIndex> observations,
                                        const Calibration& calibration) {
  for (const Rig& rig : calibration.rigs) {
    for (const RigCamera& camera : rig.cameras) start_.cameras.push_back(camera);
  }
  if (scope_.variable.intrinsics && scope_.variable.straight_lenses_bend) {
    for (RigCamera& camera : start_.cameras) camera.model = with_lens(camera.model);
  }
  start_.edge_bias_px.assign(start_.cameras.size(), 0.0);
  const auto& stated_sizes_m = prepared_.selection().stated_sizes_m();
  std::map<double, SizeClassIndex> class_of_size;
  for (const double size_m : stated_sizes_m) class_of_size.emplace(size_m, SizeClassIndex());
  for (auto& [size_m, index] : class_of_size) {
    index = start_.size_factor.push_back(1.0);
    size_of_class_m_.push_back(size_m);
  }
  for (const double size_m : stated_sizes_m) {
    size_class_of_marker_.push_back(class_of_size.at(size_m));
  }

  const Observations& all = prepared_.observations();
  IndexedVector<CameraIndex, char> camera_sees(start_.cameras.size(), 0);
  IndexedVector<SizeClassIndex, char> size_is_seen(start_.size_factor.size(), 0);
  for (const ObservationIndex index : observations) {
    camera_sees[all[index].camera] = 1;
    size_is_seen[size_class_of(all[index].marker)] = 1;
  }
  layout_.coefficients = scope_.variable.coefficients;
  const auto number = [&](bool varies) { return varies ? layout_.blocks++ : -1; };
  for (const CameraIndex c : start_.cameras.indices()) {
    const bool sees = camera_sees[c] != 0;
    const bool carries_rig = all.cameras[c].in_rig == 0;
    const bool has_lens = start_.cameras[c].model.parameters().distortion != Distortion::none;
    layout_.extrinsics.push_back(number(scope_.variable.extrinsics && sees && !carries_rig));
    layout_.focal.push_back(number(scope_.variable.intrinsics && sees));
    layout_.lens.push_back(number(scope_.variable.intrinsics && sees && has_lens));
    layout_.edge_bias.push_back(number(scope_.variable.edge_bias && sees));
  }
  for (const char seen : size_is_seen) {
    layout_.size.push_back(number(scope_.variable.sizes && seen != 0));
  }
}

void ReducedProblem::number_frame_sets(std::span<const ObservationIndex> observations,
                                       const ConstantPoses& constant, const Estimate& estimate) {
  const Observations& all = prepared_.observations();
  std::vector<ObservationIndex> sorted(observations.begin(), observations.end());
  std::sort(sorted.begin(), sorted.end(), [&](ObservationIndex a, ObservationIndex b) {
    return std::pair(all[a].frame_set, a) < std::pair(all[b].frame_set, b);
  });
  IndexedVector<RigIndex, char> next_is_odd(all.rigs.size(), 0);
  for (const ObservationIndex index : sorted) {
    const FrameSetIndex frame_set = all[index].frame_set;
    if (sets_.empty() || frame_sets_.back() != frame_set) {
      FrameSetSlot set;
      set.first = observations_.size();
      set.constant = constant.holds(frame_set);
      char& odd = next_is_odd[all.frame_sets[frame_set].rig];
      set.odd = odd != 0;
      odd = odd == 0 ? 1 : 0;
      sets_.push_back(set);
      frame_sets_.push_back(frame_set);
      start_.world_from_rig.push_back(estimate.world_from_rig[frame_set]->best.pose);
    }
    ++sets_.back().count;
    observations_.push_back(slot_of(index));
    const std::vector<int> touched = blocks_of(observations_.back());
    sets_.back().blocks.insert(sets_.back().blocks.end(), touched.begin(), touched.end());
  }
  std::size_t blocks = 0;
  for (FrameSetSlot& set : sets_) {
    std::sort(set.blocks.begin(), set.blocks.end());
    set.blocks.erase(std::unique(set.blocks.begin(), set.blocks.end()), set.blocks.end());
    set.first_block = blocks;
    blocks += set.blocks.size();
  }
  rigs_.resize(sets_.size());
  back_substitution_.resize(blocks);
}

// A rational lens's numerator and denominator trade against each other: what bends nothing stays
// near where it was.
void ReducedProblem::hold_further_coefficients(CameraIndex camera) {
  constexpr int kTold = 4;
  const CameraParameters& lens = start_.cameras[camera].model.parameters();
  const auto coefficients = lens_kind(lens.distortion).coefficients;
  for (int k = kTold; k < static_cast<int>(coefficients.size()); ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (layout_.row_of(camera, 4 + k) < 0) continue;
    factors_.push_back(
        intrinsic_prior(layout_, camera, 4 + k, lens.coefficients[at], coefficients[at].spread));
  }
}

void ReducedProblem::take_factors_of_scope(const Calibration& calibration) {
  if (scope_.survey != nullptr) {
    factors_ = survey_factors(*scope_.survey, prepared_.observations(), calibration, *this,
                              scope_.world_of_marker);
  }
  if (scope_.variable.sizes) {
    std::map<SizeClassIndex, double> already;
    for (const MarkerIndex m : calibration.sizes_m.indices()) {
      already.emplace(size_class_of(m),
                      calibration.sizes_m[m] / prepared_.selection().stated_sizes_m()[m]);
    }
    for (const auto& [size_class, factor] : already) {
      if (layout_.size[size_class] < 0) continue;
      factors_.push_back(size_prior(layout_, size_class, factor, scope_.size_sigma));
    }
  }
  for (const ConstantDirection& direction : scope_.constant_directions) {
    factors_.push_back(direction_factor(layout_, scope_.stated_cameras, direction));
  }
  for (const CameraIndex c : start_.cameras.indices()) hold_further_coefficients(c);
  if (scope_.variable.edge_bias) {
    for (const CameraIndex c : start_.cameras.indices()) {
      if (layout_.edge_bias[c] < 0) continue;
      factors_.push_back(
          edge_bias_prior(layout_, c, calibration.edge_bias_px(c), scope_.edge_bias_sigma_px));
    }
  }
}

ReducedProblem::ObservationSlot ReducedProblem::slot_of(ObservationIndex index) const {
  const Observation& o = prepared_.observations()[index];
  ObservationSlot slot;
  slot.observation = &prepared_[index];
  slot.marker = *slot_of_[o.marker];
  slot.block = block_of(o.marker).value_or(-1);
  slot.size_class = size_class_of(o.marker);
  slot.camera = o.camera;
  if (scope_.variable.edge_bias) slot.outward = outward_of(prepared_[index].corners_px);
  return slot;
}

std::vector<int> ReducedProblem::blocks_of(const ObservationSlot& slot) const {
  std::vector<int> blocks{slot.block,
                          layout_.extrinsics[slot.camera],
                          layout_.focal[slot.camera],
                          layout_.lens[slot.camera],
                          layout_.edge_bias[slot.camera],
                          layout_.size[slot.size_class]};
  std::erase(blocks, -1);
  return blocks;
}

Estimate ReducedProblem::estimate_at(const BundleVariables& at, Estimate estimate) const {
  const Observations& all = prepared_.observations();
  if (scope_.variable.any()) {
    for (const CameraIndex c : at.cameras.indices()) {
      const CameraPlace& place = all.cameras[c];
      estimate.calibration.rigs[place.rig].cameras[place.in_rig] = at.cameras[c];
      if (at.edge_bias_px[c] != 0.0) {
        estimate.calibration.edge_bias_steps_px[c].push_back(at.edge_bias_px[c]);
      }
    }
    for (const MarkerIndex m : estimate.calibration.sizes_m.indices()) {
      estimate.calibration.sizes_m[m] *= at.size_factor[size_class_of(m)];
    }
  }
  for (std::size_t m = 0; m < markers_.size(); ++m) {
    estimate.world_from_marker[markers_[m]] = at.world_from_marker[m];
  }
  for (std::size_t f = 0; f < frame_sets_.size(); ++f) {
    estimate.world_from_rig[frame_sets_[f]]->best.pose = at.world_from_rig[f];
  }
  return estimate;
}

}  // namespace waymark
