#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/estimate/calibration_prior.h"
#include "locd/camera_mask.h"

namespace waymark {

/// One observation as evidence: whitened by its noise alone.
struct EvidenceRow {
  std::size_t map_index = 0;
  std::size_t camera = 0;
  std::size_t size = 0;  ///< of its marker, among CalibrationPrior's
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
  /// Markers of a block, and those that are asked about at a time: of more the first seen in a
  /// block, and as many of the newest blocks as hold no others.
  static constexpr std::size_t kMostMarkers = 40;

  /// `blocks`: how many are kept (2–kBlocks).
  explicit Evidence(const CalibrationPrior& prior, int blocks = kBlocks);

  /// Whether markers at `distance_m`, the mean of a set, are seen by a rig here otherwise than in
  /// the last set that was taken: from another direction, or elsewhere in the image.
  [[nodiscard]] bool is_new(const Rigid3& world_from_rig, double distance_m) const;
  /// Takes a set's observations.
  void add(const Rigid3& world_from_rig, std::span<const EvidenceRow> rows);
  /// Forgets all sets.
  void clear();

  /// Sets that were taken since the start.
  [[nodiscard]] long sets() const { return sets_; }
  /// Normal equations of some sets: first cameras' and sizes' numbers, then six of each marker.
  struct System {
    Eigen::MatrixXd information;  ///< as large as it may become; the upper left part is used
    Eigen::VectorXd evidence;
    std::vector<std::size_t> markers;  ///< map indices, in their order
    std::vector<int> views;            ///< of each marker: sets that show it
    std::vector<CameraMask> seen_by;   ///< of each marker: the cameras
    std::vector<int> sets_of_camera;   ///< observations of each camera
    int sets = 0;
  };
  /// The newest sets as one system; `blocks` of them, at least half a block.
  void sum(int blocks, System& system) const;
  /// One block alone: 0 the newest, 1 the one before.
  void block(int age, System& system) const;
  /// Which of all blocks since the start that is, from 1; 0: it is empty.
  [[nodiscard]] long number_of(int age) const {
    return block_of(age).sets > 0 ? block_of(age).number : 0;
  }

 private:
  struct Block : System {
    long number = 0;
  };
  /// Where some numbers stand.
  struct Part {
    Eigen::Index at, size;
    bool operator==(const Part&) const = default;
  };
  void prepare(System& system) const;
  void empty(System& system) const;
  void begin_block();
  [[nodiscard]] const Block& block_of(int age) const {
    const std::size_t kept = blocks_.size();
    return blocks_[(newest_ + kept - static_cast<std::size_t>(age)) % kept];
  }
  /// The marker's place among a system's; it is given one where there is room.
  [[nodiscard]] static std::optional<std::size_t> slot_in(System& system, std::size_t map_index);
  [[nodiscard]] Eigen::Index at_marker(std::size_t slot) const {
    return calibration_ + 6 * static_cast<Eigen::Index>(slot);
  }
  void eliminate_pose(Matrix6d& of_pose, Vector6d& pull, System& system);
  /// False: it holds markers for which there is no room.
  [[nodiscard]] bool add_block(const Block& block, System& system) const;

  std::size_t cameras_;
  Eigen::Index first_size_;
  Eigen::Index calibration_;  ///< numbers of cameras and sizes
  std::vector<Block> blocks_;
  std::size_t newest_ = 0;
  long sets_ = 0;
  long blocks_begun_ = 0;
  std::optional<Rigid3> last_world_from_rig_;       ///< of the last set that was taken
  Eigen::Matrix<double, 6, Eigen::Dynamic> cross_;  ///< of a set, between its pose and all else
  std::vector<Part> touched_;                       ///< by a set
};

}  // namespace waymark
