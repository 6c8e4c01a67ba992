#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/estimate/calibration_prior.h"

namespace waymark {

/// One observation as evidence: whitened by its noise alone.
struct EvidenceRow {
  std::size_t map_index = 0;
  std::size_t camera = 0;
  std::size_t size = 0;    ///< of its marker, among CalibrationPrior's
  ErrorColumns columns;
};

/// Least squares over frame sets in which the rig moved, every set's own pose eliminated: what they
/// say together of the numbers of cameras and sizes (CalibrationPrior's order and units) and of the
/// markers' places (Rigid3's tangents). Kept in blocks of sets, so that what is old can go.
///
/// Only what is seen anew counts: a set in which the rig has hardly moved since the last that was
/// taken adds nothing, for a standing vehicle sees the same errors again and again.
class Evidence {
 public:
  static constexpr int kSetsPerBlock = 8;
  /// Blocks that are kept for the longest question.
  static constexpr int kBlocks = 17;
  /// Markers that are asked about at a time. Where more come, the oldest blocks go, so that the newest
  /// are told of; of more in one block, the first seen.
  static constexpr std::size_t kMostMarkers = 32;

  /// `blocks`: how many are kept (2–kBlocks).
  Evidence(const CalibrationPrior& prior, std::size_t map_markers, int blocks = kBlocks);

  /// Whether markers at `distance_m`, the mean of a set, are seen by a rig here otherwise than in
  /// the last set that was taken: from another direction, or elsewhere in the image.
  [[nodiscard]] bool is_new(const Rigid3& world_from_rig, double distance_m) const;
  /// Takes a set's observations.
  void add(const Rigid3& world_from_rig, std::span<const EvidenceRow> rows);
  /// Forgets all sets.
  void clear();

  /// Sets that were taken since the start.
  [[nodiscard]] long sets() const { return sets_; }
  /// The newest sets as one system; `blocks` of them, at least half a block.
  struct System {
    Eigen::MatrixXd information;
    Eigen::VectorXd evidence;
    std::vector<std::size_t> markers;  ///< by slot, map index
    std::vector<int> views;            ///< new ones, by slot
    std::vector<int> sets_of_camera;
    int sets = 0;
  };
  void sum(int blocks, System& system) const;
  /// One block alone: 0 the newest, 1 the one before.
  void block(int age, System& system) const;

 private:
  struct Part {
    Eigen::Index at, size;
    bool operator==(const Part&) const = default;
  };
  struct Block {
    Eigen::MatrixXd information;
    Eigen::VectorXd evidence;
    std::vector<Part> parts;  ///< of it that are not zero
    std::vector<int> views;
    std::vector<int> sets_of_camera;
    int sets = 0;
  };
  void begin_block();
  void empty(Block& block);
  void free_unused_slots();
  [[nodiscard]] bool forget_oldest_block();
  [[nodiscard]] const Block& block_of(int age) const {
    const std::size_t kept = blocks_.size();
    return blocks_[(newest_ + kept - static_cast<std::size_t>(age)) % kept];
  }
  [[nodiscard]] std::optional<std::size_t> slot_for(std::size_t map_index);
  static void touch(const Part& part, std::vector<Part>& parts);

  std::size_t cameras_;
  Eigen::Index first_size_;
  Eigen::Index calibration_;                 ///< numbers of cameras and sizes
  std::vector<int> slot_of_marker_;          ///< −1: none
  std::vector<std::size_t> marker_of_slot_;  ///< kNone: free
  std::vector<Block> blocks_;
  std::size_t newest_ = 0;
  long sets_ = 0;
  std::optional<Rigid3> last_world_from_rig_;  ///< of the last set that was taken
  Eigen::Matrix<double, 6, Eigen::Dynamic> cross_;  ///< of a set, between its pose and all else
  std::vector<Part> touched_;
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
};

}  // namespace waymark
