#include "locd/pose/evidence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "core/base/check.h"

namespace waymark {
namespace {

/// Beyond, what is seen is seen anew: of the direction to markers and of the rig's own, together
/// (rad); some thirtieth of an image.
constexpr double kNewView_rad = 0.03;

}  // namespace

Evidence::Evidence(const CalibrationPrior& prior, std::size_t map_markers, int blocks)
    : cameras_(prior.cameras()),
      first_size_(prior.at_size(0)),
      calibration_(prior.numbers()),
      slot_of_marker_(map_markers, -1),
      marker_of_slot_(kMostMarkers, kNone),
      blocks_(static_cast<std::size_t>(blocks)) {
  WAYMARK_CHECK(blocks >= 2 && blocks <= kBlocks);
  touched_.reserve(cameras_ + prior.sizes() + kMostMarkers);
  const Eigen::Index size = calibration_ + 6 * static_cast<Eigen::Index>(kMostMarkers);
  for (Block& block : blocks_) {
    block.information.setZero(size, size);
    block.evidence.setZero(size);
    block.parts.reserve(touched_.capacity());
    block.views.assign(kMostMarkers, 0);
    block.sets_of_camera.assign(cameras_, 0);
  }
  cross_.setZero(6, size);
}

void Evidence::clear() {
  for (std::size_t i = 0; i < blocks_.size(); ++i) begin_block();
  last_world_from_rig_.reset();
}

/// The oldest block becomes the newest, empty.
void Evidence::begin_block() {
  newest_ = (newest_ + 1) % blocks_.size();
  empty(blocks_[newest_]);
  free_unused_slots();
}

void Evidence::empty(Block& block) {
  for (const Part& a : block.parts) {
    block.evidence.segment(a.at, a.size).setZero();
    for (const Part& b : block.parts) {
      block.information.block(a.at, b.at, a.size, b.size).setZero();
    }
  }
  block.parts.clear();
  std::fill(block.views.begin(), block.views.end(), 0);
  std::fill(block.sets_of_camera.begin(), block.sets_of_camera.end(), 0);
  block.sets = 0;
}

/// Markers that no block knows any more make room.
void Evidence::free_unused_slots() {
  for (std::size_t slot = 0; slot < kMostMarkers; ++slot) {
    const bool used = std::any_of(blocks_.begin(), blocks_.end(),
                                  [&](const Block& b) { return b.views[slot] > 0; });
    if (used || marker_of_slot_[slot] == kNone) continue;
    slot_of_marker_[marker_of_slot_[slot]] = -1;
    marker_of_slot_[slot] = kNone;
  }
}

/// False: there is none but the newest.
bool Evidence::forget_oldest_block() {
  for (std::size_t i = 1; i < blocks_.size(); ++i) {
    Block& block = blocks_[(newest_ + i) % blocks_.size()];
    if (block.sets == 0) continue;
    empty(block);
    free_unused_slots();
    return true;
  }
  return false;
}

std::optional<std::size_t> Evidence::slot_for(std::size_t map_index) {
  int& slot = slot_of_marker_[map_index];
  if (slot >= 0) return static_cast<std::size_t>(slot);
  for (;;) {
    const auto free = std::find(marker_of_slot_.begin(), marker_of_slot_.end(), kNone);
    if (free != marker_of_slot_.end()) {
      *free = map_index;
      slot = static_cast<int>(free - marker_of_slot_.begin());
      return static_cast<std::size_t>(slot);
    }
    if (!forget_oldest_block()) return std::nullopt;
  }
}

bool Evidence::is_new(const Rigid3& world_from_rig, double distance_m) const {
  if (!last_world_from_rig_) return true;
  const Rigid3& last = *last_world_from_rig_;
  const double moved_m = (world_from_rig.translation - last.translation).norm();
  const double turned_rad = angle_between_rad(world_from_rig.rotation, last.rotation);
  return moved_m / std::max(distance_m, 1e-3) + turned_rad >= kNewView_rad;
}

void Evidence::touch(const Part& part, std::vector<Part>& parts) {
  if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
}

void Evidence::add(const Rigid3& world_from_rig, std::span<const EvidenceRow> rows) {
  if (blocks_[newest_].sets >= kSetsPerBlock) begin_block();
  Block& block = blocks_[newest_];
  Matrix6d of_pose = 1e-9 * Matrix6d::Identity();
  Vector6d pull = Vector6d::Zero();
  cross_.setZero();
  touched_.clear();
  constexpr Eigen::Index kCalibration = kCalibrationNumbers;
  for (const EvidenceRow& row : rows) {
    const auto slot = slot_for(row.map_index);
    if (!slot) continue;
    const std::array<Part, 3> parts{{{CalibrationPrior::first_of(row.camera), kCalibration},
                                     {first_size_ + static_cast<Eigen::Index>(row.size), 1},
                                     {calibration_ + 6 * static_cast<Eigen::Index>(*slot), 6}}};
    Eigen::Matrix<double, 8, kCalibration + 1 + 6> columns;
    columns << row.columns.by_camera * CalibrationPrior::units().asDiagonal(),
        row.columns.by_size * CalibrationPrior::kSizeUnit, row.columns.by_marker;
    const std::array<Eigen::Index, 3> from{0, kCalibration, kCalibration + 1};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto of_a = columns.middleCols(from[a], parts[a].size);
      touch(parts[a], touched_);
      touch(parts[a], block.parts);
      block.evidence.segment(parts[a].at, parts[a].size).noalias() +=
          of_a.transpose() * row.columns.residual;
      cross_.middleCols(parts[a].at, parts[a].size).noalias() +=
          row.columns.by_pose.transpose() * of_a;
      for (std::size_t b = 0; b < 3; ++b) {
        block.information.block(parts[a].at, parts[b].at, parts[a].size, parts[b].size).noalias() +=
            of_a.transpose() * columns.middleCols(from[b], parts[b].size);
      }
    }
    of_pose += row.columns.by_pose.transpose() * row.columns.by_pose;
    pull += row.columns.by_pose.transpose() * row.columns.residual;
    ++block.views[*slot];
    ++block.sets_of_camera[row.camera];
  }
  if (touched_.empty()) {
    // All its markers came after those that fill this block: the next set begins another.
    if (block.sets > 0) begin_block();
    return;
  }
  // The set's pose goes.
  const Eigen::LLT<Matrix6d> factor(of_pose);
  factor.matrixL().solveInPlace(pull);
  for (const Part& a : touched_) {
    auto of_a = cross_.middleCols(a.at, a.size);
    factor.matrixL().solveInPlace(of_a);
    block.evidence.segment(a.at, a.size).noalias() -= of_a.transpose() * pull;
  }
  for (const Part& a : touched_) {
    for (const Part& b : touched_) {
      block.information.block(a.at, b.at, a.size, b.size).noalias() -=
          cross_.middleCols(a.at, a.size).transpose() * cross_.middleCols(b.at, b.size);
    }
  }
  ++block.sets;
  ++sets_;
  last_world_from_rig_ = world_from_rig;
}

void Evidence::block(int age, System& system) const {
  const Block& block = block_of(age);
  system.information = block.information;
  system.evidence = block.evidence;
  system.views = block.views;
  system.sets_of_camera = block.sets_of_camera;
  system.sets = block.sets;
  system.markers = marker_of_slot_;
}

void Evidence::sum(int blocks, System& system) const {
  block(0, system);
  const int whole = 2 * system.sets >= kSetsPerBlock ? blocks - 1 : blocks;
  const int oldest = static_cast<int>(blocks_.size()) - 1;
  for (int age = 1; age <= std::min(whole, oldest); ++age) {
    const Block& block = block_of(age);
    if (block.sets == 0) continue;
    for (const Part& a : block.parts) {
      for (const Part& b : block.parts) {
        system.information.block(a.at, b.at, a.size, b.size) +=
            block.information.block(a.at, b.at, a.size, b.size);
      }
    }
    system.evidence += block.evidence;
    system.sets += block.sets;
    for (std::size_t i = 0; i < kMostMarkers; ++i) system.views[i] += block.views[i];
    for (std::size_t c = 0; c < cameras_; ++c) system.sets_of_camera[c] += block.sets_of_camera[c];
  }
}

}  // namespace waymark
