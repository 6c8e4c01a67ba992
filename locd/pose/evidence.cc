#include "locd/pose/evidence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bitset>

#include "core/base/check.h"

namespace waymark {
namespace {

/// Beyond, what is seen is seen anew: of the direction to markers and of the rig's own, together
/// (rad); some fiftieth of an image.
constexpr double kNewView_rad = 0.02;

}  // namespace

Evidence::Evidence(const CalibrationPrior& prior, int blocks)
    : cameras_(prior.cameras()),
      first_size_(prior.at_size(0)),
      calibration_(prior.numbers()),
      blocks_(static_cast<std::size_t>(blocks)) {
  WAYMARK_CHECK(blocks >= 2 && blocks <= kBlocks);
  touched_.reserve(cameras_ + prior.sizes() + kMostMarkers);
  for (Block& block : blocks_) prepare(block);
  cross_.setZero(6, at_marker(kMostMarkers));
}

/// Makes it as large as it may become, empty.
void Evidence::prepare(System& system) const {
  const Eigen::Index size = at_marker(kMostMarkers);
  system.information.setZero(size, size);
  system.evidence.setZero(size);
  system.markers.reserve(kMostMarkers);
  system.views.reserve(kMostMarkers);
  system.seen_by.reserve(kMostMarkers);
  system.sets_of_camera.assign(cameras_, 0);
  system.sets = 0;
}

void Evidence::empty(System& system) const {
  const Eigen::Index used = at_marker(system.markers.size());
  system.information.topLeftCorner(used, used).setZero();
  system.evidence.head(used).setZero();
  system.markers.clear();
  system.views.clear();
  system.seen_by.clear();
  std::fill(system.sets_of_camera.begin(), system.sets_of_camera.end(), 0);
  system.sets = 0;
}

void Evidence::clear() {
  for (std::size_t i = 0; i < blocks_.size(); ++i) begin_block();
  last_world_from_rig_.reset();
}

/// The oldest block becomes the newest, empty.
void Evidence::begin_block() {
  newest_ = (newest_ + 1) % blocks_.size();
  empty(blocks_[newest_]);
  blocks_[newest_].number = ++blocks_begun_;
}

std::optional<std::size_t> Evidence::slot_in(System& system, std::size_t map_index) {
  const auto found = std::find(system.markers.begin(), system.markers.end(), map_index);
  if (found == system.markers.end()) {
    if (system.markers.size() == kMostMarkers) return std::nullopt;
    system.markers.push_back(map_index);
    system.views.push_back(0);
    system.seen_by.push_back(0);
    return system.markers.size() - 1;
  }
  return static_cast<std::size_t>(found - system.markers.begin());
}

bool Evidence::is_new(const Rigid3& world_from_rig, double distance_m) const {
  if (!last_world_from_rig_) return true;
  const Rigid3& last = *last_world_from_rig_;
  const double moved_m = (world_from_rig.translation - last.translation).norm();
  const double turned_rad = angle_between_rad(world_from_rig.rotation, last.rotation);
  return moved_m / std::max(distance_m, 1e-3) + turned_rad >= kNewView_rad;
}

void Evidence::add(const Rigid3& world_from_rig, std::span<const EvidenceRow> rows) {
  if (blocks_[newest_].sets >= kSetsPerBlock) begin_block();
  Block& block = blocks_[newest_];
  Matrix6d of_pose = 1e-9 * Matrix6d::Identity();
  Vector6d pull = Vector6d::Zero();
  cross_.setZero();
  touched_.clear();
  std::bitset<kMostMarkers> seen;  // by several cameras or by one, it is one view
  constexpr Eigen::Index kCalibration = kCalibrationNumbers;
  for (const EvidenceRow& row : rows) {
    const auto slot = slot_in(block, row.map_index);
    if (!slot) continue;
    const std::array<Part, 3> parts{{{CalibrationPrior::first_of(row.camera), kCalibration},
                                     {first_size_ + static_cast<Eigen::Index>(row.size), 1},
                                     {at_marker(*slot), 6}}};
    Eigen::Matrix<double, 8, kCalibration + 1 + 6> columns;
    columns << row.columns.by_camera * CalibrationPrior::units().asDiagonal(),
        row.columns.by_size * CalibrationPrior::kSizeUnit, row.columns.by_marker;
    const std::array<Eigen::Index, 3> from{0, kCalibration, kCalibration + 1};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto of_a = columns.middleCols(from[a], parts[a].size);
      if (std::find(touched_.begin(), touched_.end(), parts[a]) == touched_.end()) {
        touched_.push_back(parts[a]);
      }
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
    block.views[*slot] += seen[*slot] ? 0 : 1;
    seen.set(*slot);
    block.seen_by[*slot] |= camera_bit(row.camera);
    ++block.sets_of_camera[row.camera];
  }
  if (touched_.empty()) {
    // All its markers came after those that fill this block: the next set begins another.
    if (block.sets > 0) begin_block();
    return;
  }
  eliminate_pose(of_pose, pull, block);
  ++block.sets;
  ++sets_;
  last_world_from_rig_ = world_from_rig;
}

/// Of the set whose numbers are `touched_`.
void Evidence::eliminate_pose(Matrix6d& of_pose, Vector6d& pull, System& system) {
  const Eigen::LLT<Matrix6d> factor(of_pose);
  factor.matrixL().solveInPlace(pull);
  for (const Part& a : touched_) {
    auto of_a = cross_.middleCols(a.at, a.size);
    factor.matrixL().solveInPlace(of_a);
    system.evidence.segment(a.at, a.size).noalias() -= of_a.transpose() * pull;
  }
  for (const Part& a : touched_) {
    for (const Part& b : touched_) {
      system.information.block(a.at, b.at, a.size, b.size).noalias() -=
          cross_.middleCols(a.at, a.size).transpose() * cross_.middleCols(b.at, b.size);
    }
  }
}

bool Evidence::add_block(const Block& block, System& system) const {
  const auto known = [&](std::size_t marker) {
    return std::find(system.markers.begin(), system.markers.end(), marker) != system.markers.end();
  };
  const auto others = std::count_if(block.markers.begin(), block.markers.end(),
                                    [&](std::size_t marker) { return !known(marker); });
  if (system.markers.size() + static_cast<std::size_t>(others) > kMostMarkers) return false;
  system.information.topLeftCorner(calibration_, calibration_) +=
      block.information.topLeftCorner(calibration_, calibration_);
  system.evidence.head(calibration_) += block.evidence.head(calibration_);
  for (std::size_t i = 0; i < block.markers.size(); ++i) {
    const std::size_t slot = *slot_in(system, block.markers[i]);
    const Eigen::Index from = at_marker(i);
    const Eigen::Index to = at_marker(slot);
    system.views[slot] += block.views[i];
    system.seen_by[slot] |= block.seen_by[i];
    system.evidence.segment<6>(to) += block.evidence.segment<6>(from);
    system.information.block(to, 0, 6, calibration_) +=
        block.information.block(from, 0, 6, calibration_);
    system.information.block(0, to, calibration_, 6) +=
        block.information.block(0, from, calibration_, 6);
    for (std::size_t k = 0; k < block.markers.size(); ++k) {
      const Eigen::Index to_k = at_marker(*slot_in(system, block.markers[k]));
      system.information.block<6, 6>(to, to_k) += block.information.block<6, 6>(from, at_marker(k));
    }
  }
  for (std::size_t c = 0; c < cameras_; ++c) system.sets_of_camera[c] += block.sets_of_camera[c];
  system.sets += block.sets;
  return true;
}

void Evidence::block(int age, System& system) const {
  if (system.information.size() == 0) prepare(system);
  empty(system);
  static_cast<void>(add_block(block_of(age), system));
}

void Evidence::sum(int blocks, System& system) const {
  block(0, system);
  const int whole = 2 * system.sets >= kSetsPerBlock ? blocks - 1 : blocks;
  const int oldest = static_cast<int>(blocks_.size()) - 1;
  for (int age = 1; age <= std::min(whole, oldest); ++age) {
    if (!add_block(block_of(age), system)) return;
  }
}

}  // namespace waymark
