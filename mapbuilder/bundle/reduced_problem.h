#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/bundle/block_matrix.h"
#include "mapbuilder/bundle/bundle_problem.h"
#include "mapbuilder/bundle/bundle_variables.h"

namespace waymark {

/// One observation's residual in sigmas with its derivatives, six columns each.
struct ObservationLinearization {
  using Jacobian86 = Eigen::Matrix<double, 8, 6>;
  struct Part {
    int block = 0;
    Jacobian86 jacobian;
  };
  Eigen::Matrix<double, 8, 1> residual;
  Jacobian86 rig;
  std::array<Part, 6> parts;  ///< by the blocks that it touches
  std::size_t part_count = 0;
};

/// The normal equations with the rig poses eliminated, six rows per block: the
/// Schur complement S = H_bb − Σ H_br H_rr⁻¹ H_rb and the gradient that goes with it.
struct ReducedSystem {
  BlockMatrix information;
  Eigen::VectorXd gradient;
  Eigen::VectorXd diagonal;  ///< of H_bb, before the elimination
  double cost = 0;           ///< ½ Σ ρ, sigmas²
};

/// Which frame sets count: all of them, or one half: of each rig every second one, by their order.
enum class FrameSetHalf { all, even, odd };

/// A bundle problem's variables numbered and its normal equations reduced: the rig poses are
/// eliminated, what remains are blocks of six, the markers' first, then the calibration's (unused
/// rows carry a unit diagonal). Sums run over a fixed number of slices in a fixed order: the result
/// does not depend on the number of threads.
class ReducedProblem {
 public:
  /// Of the given observations, which must have both ends posed, whether or not the gate accepts
  /// them, with these poses constant and the problem's scope and loss. Problem and estimate's
  /// observations must outlive it. `threads` ≥ 1.
  ReducedProblem(const BundleProblem& problem, std::span<const ObservationIndex> observations,
                 const ConstantPoses& constant, const Estimate& estimate, int threads);

  /// A further residual on blocks alone, beside those of the scope.
  void add(std::unique_ptr<BundleFactor> factor) { factors_.push_back(std::move(factor)); }

  [[nodiscard]] const BundleVariables& start() const { return start_; }
  /// The markers that take part: the variable ones by block, then the constant ones.
  [[nodiscard]] const std::vector<MarkerIndex>& markers() const { return markers_; }
  /// Block of a marker; nullopt when it takes no part or is constant.
  [[nodiscard]] std::optional<int> block_of(MarkerIndex marker) const;
  /// By rising stated size.
  [[nodiscard]] SizeClassIndex size_class_of(MarkerIndex marker) const {
    return size_class_of_marker_[marker];
  }
  [[nodiscard]] double stated_size_m(SizeClassIndex size_class) const {
    return size_of_class_m_[size_class];
  }
  /// That take part.
  [[nodiscard]] const std::vector<FrameSetIndex>& frame_sets() const { return frame_sets_; }
  [[nodiscard]] const ReducedLayout& layout() const { return layout_; }
  [[nodiscard]] const BlockPattern& pattern() const { return pattern_; }
  [[nodiscard]] const std::vector<std::unique_ptr<BundleFactor>>& factors() const {
    return factors_;
  }

  /// ½ Σ ρ; infinite when a corner leaves its camera's domain.
  [[nodiscard]] double cost(const BundleVariables& at) const;

  /// Linearizes at `at`, with H_rr damped by (1 + damping) on its diagonal, over the frame sets of
  /// `half` and all factors. Remembers what the back-substitution needs.
  [[nodiscard]] ReducedSystem reduce(const BundleVariables& at, double damping,
                                     FrameSetHalf half = FrameSetHalf::all);

  /// For solvers that eliminate by themselves: the observations that take part, each with the slot
  /// of its frame set, and whether that is constant.
  [[nodiscard]] std::size_t observation_count() const { return observations_.size(); }
  [[nodiscard]] std::size_t frame_set_slot(std::size_t observation) const;
  [[nodiscard]] bool is_constant(std::size_t frame_set_slot) const {
    return sets_[frame_set_slot].constant;
  }
  [[nodiscard]] std::vector<int> blocks_of(std::size_t observation) const {
    return blocks_of(observations_[observation]);
  }
  /// False when a corner lies outside its camera's domain. No loss is applied.
  bool linearize(const BundleVariables& at, std::size_t observation,
                 ObservationLinearization& result) const {
    return linearize(at, frame_set_slot(observation), observations_[observation], result);
  }

  /// The variables moved by a step of the blocks and by the rig steps that back-substitution gives
  /// (of the last reduce). `promised`: ½ δᵀ(λDδ − g) of the rigs, the decrease the quadratic model
  /// expects of them.
  [[nodiscard]] BundleVariables moved(const BundleVariables& from, const Eigen::VectorXd& step,
                                      double& promised) const;

  /// The estimate with these values.
  [[nodiscard]] Estimate estimate_at(const BundleVariables& at, Estimate estimate) const;

 private:
  struct FrameSetSlot {
    std::size_t first = 0;  ///< in observations_
    std::size_t count = 0;
    bool constant = false;
    bool odd = false;             ///< among those of its rig
    std::size_t first_block = 0;  ///< in back_substitution_
    std::vector<int> blocks;      ///< that it touches, rising
  };
  struct ObservationSlot {
    const MarkerObservation* observation = nullptr;
    std::size_t marker = 0;  ///< slot
    int block = 0;           ///< of the marker; −1: constant
    SizeClassIndex size_class;
    CameraIndex camera;
    std::array<Eigen::Vector2d, 4> outward;  ///< how a corner moves per px of edge bias
  };
  /// What one slice of frame sets adds.
  struct SliceSums {
    std::vector<Matrix6d> blocks;
    Eigen::VectorXd gradient;
    Eigen::VectorXd diagonal;
    double cost = 0;
  };
  /// How a rig's step follows from those of the blocks: δ_r = −offset − Σ B_b δ_b.
  struct EliminatedRig {
    Vector6d offset = Vector6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    Vector6d damping = Vector6d::Zero();  ///< λ D
  };
  void number_markers(std::span<const ObservationIndex> observations, const ConstantPoses& constant,
                      const Estimate& estimate);
  void number_calibration(std::span<const ObservationIndex> observations,
                          const Calibration& calibration);
  void number_frame_sets(std::span<const ObservationIndex> observations,
                         const ConstantPoses& constant, const Estimate& estimate);
  void hold_further_coefficients(CameraIndex camera);
  void take_factors_of_scope(const Calibration& calibration);
  [[nodiscard]] bool counts(std::size_t set_slot, FrameSetHalf half) const {
    return half == FrameSetHalf::all || sets_[set_slot].odd == (half == FrameSetHalf::odd);
  }
  [[nodiscard]] ObservationSlot slot_of(ObservationIndex index) const;
  [[nodiscard]] std::vector<int> blocks_of(const ObservationSlot& slot) const;
  void cut_into_slices();
  [[nodiscard]] double observation_cost(const BundleVariables& at, std::size_t set_slot,
                                        const ObservationSlot& observation) const;
  bool linearize(const BundleVariables& at, std::size_t set_slot,
                 const ObservationSlot& observation, ObservationLinearization& result) const;
  double apply_loss(ObservationLinearization& linearization) const;
  void reduce_frame_set(const BundleVariables& at, std::size_t set_slot, double damping,
                        SliceSums& sums);

  const PreparedObservations& prepared_;
  const BundleScope& scope_;
  ObservationLoss loss_;
  int threads_;
  std::vector<MarkerIndex> markers_;                                ///< per slot
  IndexedVector<MarkerIndex, std::optional<std::size_t>> slot_of_;  ///< nullopt: takes no part
  IndexedVector<MarkerIndex, SizeClassIndex> size_class_of_marker_;
  IndexedVector<SizeClassIndex, double> size_of_class_m_;
  std::vector<FrameSetIndex> frame_sets_;  ///< per slot, rising
  std::vector<FrameSetSlot> sets_;
  std::vector<ObservationSlot> observations_;
  ReducedLayout layout_;
  BlockPattern pattern_;
  BundleVariables start_;
  std::vector<std::size_t> slices_;  ///< first set slot of each, and the end
  std::vector<EliminatedRig> rigs_;
  std::vector<Matrix6d> back_substitution_;  ///< B, per (set, block)
  std::vector<std::unique_ptr<BundleFactor>> factors_;
};

}  // namespace waymark
