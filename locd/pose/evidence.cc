#include "locd/pose/evidence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "core/base/check.h"

namespace waymark {
namespace {

/// A view is new until it was seen so often.
constexpr int kNewViews = 3;
constexpr std::size_t kViewTable = 1 << 15;

std::size_t place_of(std::uint64_t view) {
  view *= 0x9E3779B97F4A7C15ULL;
  return static_cast<std::size_t>(view >> 49U) % kViewTable;
}

}  // namespace

Evidence::Evidence(const CalibrationPrior& prior, std::size_t map_markers, int blocks)
    : cameras_(prior.cameras()),
      first_size_(prior.at_size(0)),
      calibration_(prior.numbers()),
      slot_of_marker_(map_markers, -1),
      marker_of_slot_(kMostMarkers, kNone),
      blocks_(static_cast<std::size_t>(blocks)),
      seen_views_(kViewTable, 0) {
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
}

/// The oldest block becomes the newest, empty.
void Evidence::begin_block() {
  newest_ = (newest_ + 1) % blocks_.size();
  Block& block = blocks_[newest_];
  block.information.setZero();
  block.evidence.setZero();
  block.parts.clear();
  std::fill(block.views.begin(), block.views.end(), 0);
  std::fill(block.sets_of_camera.begin(), block.sets_of_camera.end(), 0);
  block.sets = 0;
  std::fill(seen_views_.begin(), seen_views_.end(), 0);
  // Markers that no block knows any more make room.
  for (std::size_t slot = 0; slot < kMostMarkers; ++slot) {
    const bool used = std::any_of(blocks_.begin(), blocks_.end(),
                                  [&](const Block& b) { return b.views[slot] > 0; });
    if (used || marker_of_slot_[slot] == kNone) continue;
    slot_of_marker_[marker_of_slot_[slot]] = -1;
    marker_of_slot_[slot] = kNone;
  }
}

std::optional<std::size_t> Evidence::slot_for(std::size_t map_index) {
  int& slot = slot_of_marker_[map_index];
  if (slot >= 0) return static_cast<std::size_t>(slot);
  const auto free = std::find(marker_of_slot_.begin(), marker_of_slot_.end(), kNone);
  if (free == marker_of_slot_.end()) return std::nullopt;
  *free = map_index;
  slot = static_cast<int>(free - marker_of_slot_.begin());
  return static_cast<std::size_t>(slot);
}

bool Evidence::is_new(std::span<const EvidenceRow> rows) {
  std::size_t fresh = 0;
  for (const EvidenceRow& row : rows) {
    unsigned char& count = seen_views_[place_of(row.view)];
    if (count >= kNewViews) continue;
    ++count;
    ++fresh;
  }
  return 2 * fresh >= rows.size() && fresh > 0;
}

void Evidence::touch(const Part& part, std::vector<Part>& parts) {
  if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
}

void Evidence::add(std::span<const EvidenceRow> rows) {
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
  if (touched_.empty()) return;
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
