#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/bundle/block_matrix.h"
#include "mapbuilder/bundle/kept_factor.h"
#include "mapbuilder/bundle/map_state.h"

namespace waymark {

/// What may move beside the poses of markers and rigs.
struct FreeCalibration {
  bool extrinsics = false;  ///< rig_from_cam of every camera but each rig's first
  bool intrinsics = false;  ///< fu fv pu pv and the lens's coefficients of every camera
  bool sizes = false;       ///< one factor per stated size
  bool edge_bias = false;   ///< how far each camera's edges lie outside (px), all alike

  [[nodiscard]] bool any() const { return extrinsics || intrinsics || sizes || edge_bias; }
};

/// What stays where it is.
struct HeldPoses {
  std::vector<int> frame_sets;  ///< table indices
  std::vector<char> markers;    ///< per marker of the table, ≠ 0: held; empty: none

  [[nodiscard]] bool holds_marker(int marker) const {
    return !markers.empty() && markers[static_cast<std::size_t>(marker)] != 0;
  }
  [[nodiscard]] bool holds_frame_set(int frame_set) const {
    return std::find(frame_sets.begin(), frame_sets.end(), frame_set) != frame_sets.end();
  }
};

/// Values of all unknowns. World frame: the map state's.
struct JointUnknowns {
  std::vector<Rigid3> world_from_marker;  ///< per marker slot
  std::vector<Rigid3> world_from_rig;     ///< per frame set slot
  std::vector<RigCamera> cameras;         ///< of all rigs, one after the other
  std::vector<double> size_factor;        ///< per size class, on top of the observations' size
  std::vector<double> edge_bias_px;       ///< per camera, on top of the observed corners
};

/// The normal equations with the rig poses eliminated, six rows per kept block:
/// S = H_kk − Σ H_kr H_rr⁻¹ H_rk and the gradient that goes with it.
struct ReducedSystem {
  BlockMatrix information;
  Eigen::VectorXd gradient;
  Eigen::VectorXd kept_diagonal;  ///< of H_kk, before the elimination
  double cost = 0;                ///< ½ Σ ρ, sigmas²
};

/// Equation 11 as a least squares problem over markers and rigs (and, if asked, the calibration),
/// extrinsics and intrinsics else fixed. Kept blocks of six: markers by slot, then the
/// calibration's (unused rows carry a unit diagonal). Sums run over a fixed number of slices in a
/// fixed order: the result does not depend on the number of threads.
class JointProblem {
 public:
  /// Observations must have both ends posed. `threads` ≥ 1.
  JointProblem(const ObservationTable& table, std::span<const std::size_t> observations,
               const MapState& state, const HeldPoses& held, const FreeCalibration& free,
               const ObservationLoss& loss, int threads);

  /// Further residuals on kept blocks alone (survey, priors).
  void add(const KeptFactor& factor) { factors_.push_back(&factor); }

  [[nodiscard]] const JointUnknowns& start() const { return start_; }
  /// Table indices of the markers that take part: the free ones by block, then the held ones.
  [[nodiscard]] const std::vector<int>& markers() const { return markers_; }
  /// Slot (and kept block) of a marker of the table; nullopt when it takes no part or is held.
  [[nodiscard]] std::optional<int> free_marker_slot(int marker) const;
  /// Markers of one stated size are one class, by rising size.
  [[nodiscard]] int size_class_of(int marker) const {
    return size_class_of_marker_[static_cast<std::size_t>(marker)];
  }
  [[nodiscard]] const std::vector<int>& frame_sets() const { return frame_set_indices_; }
  [[nodiscard]] const KeptLayout& layout() const { return layout_; }
  [[nodiscard]] const BlockPattern& pattern() const { return pattern_; }

  /// ½ Σ ρ; infinite when a corner leaves its camera's domain.
  [[nodiscard]] double cost(const JointUnknowns& at) const;

  /// Linearizes at `at`, with H_rr damped by (1 + damping) on its diagonal. Remembers what
  /// `rig_steps` needs.
  [[nodiscard]] ReducedSystem reduce(const JointUnknowns& at, double damping);

  /// Unknowns moved by a step of the kept blocks and the rig steps that follow from it (of the last
  /// reduce). `promised`: ½ δᵀ(λDδ − g) of the rigs, the decrease the quadratic model expects of
  /// them.
  [[nodiscard]] JointUnknowns moved(const JointUnknowns& from, const Eigen::VectorXd& kept_step,
                                    double& promised) const;

 private:
  struct FrameSetSlot {
    std::size_t first = 0;  ///< in observations_
    std::size_t count = 0;
    bool fixed = false;
    std::size_t first_kept = 0;  ///< in eliminated_
    std::vector<int> kept;       ///< kept blocks it touches, rising
  };
  struct ObservationSlot {
    const TableObservation* observation = nullptr;
    int marker = 0;  ///< slot
    int block = 0;   ///< of the marker; −1: held
    int size_class = 0;
    int camera = 0;
    std::array<Eigen::Vector2d, 4> outward;  ///< how a corner moves per px of edge bias
  };
  /// What one slice of frame sets adds.
  struct SliceSums {
    std::vector<Matrix6d> blocks;
    Eigen::VectorXd gradient;
    Eigen::VectorXd kept_diagonal;
    double cost = 0;
  };
  /// How a rig follows the kept blocks: δ_r = −offset − Σ follow_k δ_k.
  struct EliminatedRig {
    Vector6d offset = Vector6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    Vector6d damping = Vector6d::Zero();  ///< λ D
  };
  struct Linearized;

  void number_unknowns(const ObservationTable& table, std::span<const std::size_t> observations,
                       const MapState& state, const HeldPoses& held);
  void number_markers(const ObservationTable& table, std::span<const std::size_t> observations,
                      const MapState& state, const HeldPoses& held);
  void number_calibration(const ObservationTable& table, std::span<const std::size_t> observations);
  void number_frame_sets(const ObservationTable& table, std::span<const std::size_t> observations,
                         const MapState& state, const HeldPoses& held);
  [[nodiscard]] std::size_t camera_slot(const ObservationTable& table,
                                        const TableObservation& o) const;
  [[nodiscard]] ObservationSlot slot_of(const ObservationTable& table,
                                        const TableObservation& o) const;
  [[nodiscard]] std::vector<int> kept_blocks_of(const ObservationSlot& slot) const;
  void cut_into_slices();
  [[nodiscard]] double observation_cost(const JointUnknowns& at, std::size_t set_slot,
                                        const ObservationSlot& observation) const;
  void linearize(const JointUnknowns& at, std::size_t set_slot, const ObservationSlot& observation,
                 Linearized& result) const;
  void reduce_frame_set(const JointUnknowns& at, std::size_t set_slot, double damping,
                        SliceSums& sums);

  FreeCalibration free_;
  ObservationLoss loss_;
  int threads_;
  std::vector<int> markers_;               ///< per slot, table index, rising
  std::vector<int> slot_of_marker_;        ///< per marker of the table; −1: takes no part
  std::vector<int> size_class_of_marker_;  ///< per marker of the table
  std::vector<std::size_t> first_camera_of_rig_;
  std::vector<int> frame_set_indices_;  ///< per slot, table index, rising
  std::vector<FrameSetSlot> sets_;
  std::vector<ObservationSlot> observations_;
  KeptLayout layout_;
  BlockPattern pattern_;
  JointUnknowns start_;
  std::vector<std::size_t> slices_;  ///< first set slot of each, and the end
  std::vector<EliminatedRig> rigs_;
  std::vector<Matrix6d> follow_;  ///< per (set, kept block)
  std::vector<const KeptFactor*> factors_;
};

}  // namespace waymark
