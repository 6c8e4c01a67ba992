// Which unknown of a JointProblem is which block, in the canonical order.
#include <algorithm>
#include <map>
#include <set>

#include "core/base/check.h"
#include "mapbuilder/bundle/edge_bias.h"
#include "mapbuilder/bundle/joint_problem.h"

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

void JointProblem::number_unknowns(const ObservationTable& table,
                                   std::span<const std::size_t> observations, const MapState& state,
                                   const HeldPoses& held) {
  number_markers(table, observations, state, held);
  number_calibration(table, observations);
  number_frame_sets(table, observations, state, held);
}

void JointProblem::number_markers(const ObservationTable& table,
                                  std::span<const std::size_t> observations, const MapState& state,
                                  const HeldPoses& held) {
  std::set<std::pair<bool, int>> taking_part;  // (held, index): the canonical order
  for (const std::size_t index : observations) {
    const int marker = table.observations[index].marker;
    taking_part.emplace(held.holds_marker(marker), marker);
  }
  slot_of_marker_.assign(table.markers.size(), -1);
  for (const auto& [is_held, marker] : taking_part) {
    const int slot = static_cast<int>(markers_.size());
    slot_of_marker_[static_cast<std::size_t>(marker)] = slot;
    markers_.push_back(marker);
    if (!is_held) layout_.markers = layout_.blocks = slot + 1;
    start_.world_from_marker.push_back(*state.world_from_marker[static_cast<std::size_t>(marker)]);
  }
}

// A camera or a size that nothing shows stays as it is: nothing could be said of it.
void JointProblem::number_calibration(const ObservationTable& table,
                                      std::span<const std::size_t> observations) {
  for (const Rig& rig : table.rigs) {
    first_camera_of_rig_.push_back(start_.cameras.size());
    start_.cameras.insert(start_.cameras.end(), rig.cameras.begin(), rig.cameras.end());
  }
  if (free_.intrinsics) {
    for (RigCamera& camera : start_.cameras) camera.model = with_lens(camera.model);
  }
  start_.edge_bias_px.assign(start_.cameras.size(), 0.0);
  std::map<double, int> class_of_size;
  for (const double size_m : table.stated_sizes_m) class_of_size.emplace(size_m, 0);
  for (auto& [size_m, index] : class_of_size) {
    index = static_cast<int>(start_.size_factor.size());
    start_.size_factor.push_back(1.0);
  }
  for (const double size_m : table.stated_sizes_m) {
    size_class_of_marker_.push_back(class_of_size.at(size_m));
  }

  std::vector<char> camera_sees(start_.cameras.size(), 0);
  std::vector<char> size_is_seen(start_.size_factor.size(), 0);
  for (const std::size_t index : observations) {
    const TableObservation& o = table.observations[index];
    camera_sees[camera_slot(table, o)] = 1;
    size_is_seen[static_cast<std::size_t>(size_class_of(o.marker))] = 1;
  }
  const auto number = [&](bool is_free) { return is_free ? layout_.blocks++ : -1; };
  for (std::size_t r = 0; r < table.rigs.size(); ++r) {
    for (std::size_t c = 0; c < table.rigs[r].cameras.size(); ++c) {
      const std::size_t slot = first_camera_of_rig_[r] + c;
      const bool sees = camera_sees[slot] != 0;
      const bool has_lens = start_.cameras[slot].model.parameters().distortion != Distortion::none;
      layout_.extrinsics.push_back(number(free_.extrinsics && sees && c > 0));
      layout_.focal.push_back(number(free_.intrinsics && sees));
      layout_.lens.push_back(number(free_.intrinsics && sees && has_lens));
      layout_.edge_bias.push_back(number(free_.edge_bias && sees));
    }
  }
  for (const char seen : size_is_seen) layout_.size.push_back(number(free_.sizes && seen != 0));
}

void JointProblem::number_frame_sets(const ObservationTable& table,
                                     std::span<const std::size_t> observations,
                                     const MapState& state, const HeldPoses& held) {
  std::vector<std::size_t> sorted(observations.begin(), observations.end());
  std::sort(sorted.begin(), sorted.end(), [&](std::size_t a, std::size_t b) {
    const int set_a = table.observations[a].frame_set;
    const int set_b = table.observations[b].frame_set;
    return set_a != set_b ? set_a < set_b : a < b;
  });
  for (const std::size_t index : sorted) {
    const TableObservation& o = table.observations[index];
    if (sets_.empty() || frame_set_indices_.back() != o.frame_set) {
      FrameSetSlot set;
      set.first = observations_.size();
      set.fixed = held.holds_frame_set(o.frame_set);
      sets_.push_back(set);
      frame_set_indices_.push_back(o.frame_set);
      start_.world_from_rig.push_back(state.rigs[static_cast<std::size_t>(o.frame_set)]->best.pose);
    }
    ++sets_.back().count;
    observations_.push_back(slot_of(table, o));
    const std::vector<int> touched = kept_blocks_of(observations_.back());
    sets_.back().kept.insert(sets_.back().kept.end(), touched.begin(), touched.end());
  }
  std::size_t kept = 0;
  for (FrameSetSlot& set : sets_) {
    std::sort(set.kept.begin(), set.kept.end());
    set.kept.erase(std::unique(set.kept.begin(), set.kept.end()), set.kept.end());
    set.first_kept = kept;
    kept += set.kept.size();
  }
  rigs_.resize(sets_.size());
  follow_.resize(kept);
}

std::size_t JointProblem::camera_slot(const ObservationTable& table,
                                      const TableObservation& o) const {
  const int rig = table.frame_sets[static_cast<std::size_t>(o.frame_set)].rig;
  return first_camera_of_rig_[static_cast<std::size_t>(rig)] + static_cast<std::size_t>(o.camera);
}

JointProblem::ObservationSlot JointProblem::slot_of(const ObservationTable& table,
                                                    const TableObservation& o) const {
  ObservationSlot slot;
  slot.observation = &o;
  slot.marker = slot_of_marker_[static_cast<std::size_t>(o.marker)];
  slot.block = slot.marker < layout_.markers ? slot.marker : -1;
  slot.size_class = size_class_of(o.marker);
  slot.camera = static_cast<int>(camera_slot(table, o));
  if (free_.edge_bias) slot.outward = outward_of(o.corners_px);
  return slot;
}

std::vector<int> JointProblem::kept_blocks_of(const ObservationSlot& slot) const {
  const auto camera = static_cast<std::size_t>(slot.camera);
  std::vector<int> blocks{slot.block,
                          layout_.extrinsics[camera],
                          layout_.focal[camera],
                          layout_.lens[camera],
                          layout_.edge_bias[camera],
                          layout_.size[static_cast<std::size_t>(slot.size_class)]};
  std::erase(blocks, -1);
  return blocks;
}

}  // namespace waymark
