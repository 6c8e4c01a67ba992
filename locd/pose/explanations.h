#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "locd/alert.h"
#include "locd/pose/evidence.h"
#include "locd/pose/map_index.h"

namespace waymark {

/// One thing that may be wrong: some numbers with a wider prior than they have.
struct Explanation {
  AlertKind kind = AlertKind::marker_moved;
  int camera = -1;            ///< whose pose, lens, clock or read-out
  std::size_t map_index = 0;  ///< of a marker

  [[nodiscard]] bool of_marker() const { return camera < 0; }
  bool operator==(const Explanation&) const = default;
};

/// How well one explains what was seen.
struct Score {
  Explanation what;
  /// Λ: log of how much likelier all is with it than without, after paying for its freedom.
  double gain = 0;
  double chi2 = 0;           ///< of the fault against its covariance
  CalibrationVector camera;  ///< the fault in its own units, and its sigmas; of a camera
  CalibrationVector camera_sigma;
  Vector6d marker = Vector6d::Zero();  ///< of a marker
  int views = 0;                       ///< new ones that tell of it
  int markers = 0;                     ///< different ones that a camera shows
};

/// Scores all explanations of one system of evidence against each other: an explanation is another
/// prior, and what the data gain by it is closed form (Gaussian evidence). Holds its memory.
class Explanations {
 public:
  /// For priors of so many cameras, sizes and modes as this one.
  Explanations(const CalibrationPrior& prior, const MapIndex& map);

  /// Begins to score all of a system. `believed`: what is known to be wrong already, which is free
  /// to be so in every score; `prior` without it. None of them may change until it is done.
  void begin(const Evidence::System& system, const CalibrationPrior& prior,
             std::span<const Explanation> believed);
  /// Goes on by a step, of which a judgement has kSteps of about equal cost; true: it is done.
  bool advance();
  static constexpr int kSteps = 8;
  /// Of the judgement that is done: best first; none where the system was no numbers.
  [[nodiscard]] std::span<const Score> scores() const { return scores_; }

  /// All of it at once.
  [[nodiscard]] std::span<const Score> judge(const Evidence::System& system,
                                             const CalibrationPrior& prior,
                                             std::span<const Explanation> believed);
  /// The score of one of them in the last judgement; nullopt: nothing told of it.
  [[nodiscard]] std::optional<Score> score_of(const Explanation& what) const;

  /// Widths (1 sigma) of a camera's numbers where it is wrong in this way, usual units.
  [[nodiscard]] static CalibrationVector widths_of(AlertKind kind);

 private:
  /// What of a marker's place is not shared, as a root.
  struct OwnRoot {
    Eigen::Index row = 0;
    Matrix6d root;
  };
  // All numbers are eliminated under their prior, step by step; false: they are no numbers.
  /// Prior roots: of what is shared, and of each marker's own.
  [[nodiscard]] bool take_roots();
  /// Rᵀ A and Rᵀ b of the prior's root R.
  void multiply_by_roots();
  /// I + Rᵀ A R
  void make_kernel();
  /// Takes L⁻¹ of some columns of Rᵀ A.
  void eliminate(Eigen::Index first, Eigen::Index count);
  void score_all();
  void score_camera(int camera, AlertKind kind);
  void score_marker(Eigen::Index at, std::size_t slot);
  [[nodiscard]] bool do_step(int step);

  const MapIndex& map_;
  std::size_t cameras_;
  const Evidence::System* system_ = nullptr;
  const CalibrationPrior* prior_ = nullptr;
  std::span<const Explanation> believed_;
  int step_ = kSteps;  ///< the next; kSteps: done
  std::vector<Score> scores_;
  Eigen::Index numbers_ = 0;   ///< of cameras and sizes
  Eigen::Index shared_ = 0;    ///< those and the modes
  Eigen::Index size_ = 0;      ///< of all that is asked about
  Eigen::Index freedoms_ = 0;  ///< of the prior
  // Each as large as it may become; the upper left part is used.
  Eigen::MatrixXd shared_root_;  ///< of the prior of cameras, sizes and modes, which markers follow
  std::vector<OwnRoot> own_roots_;
  Eigen::MatrixXd kernel_;    ///< I + Rᵀ A R, then its factor
  Eigen::MatrixXd reduced_;   ///< L⁻¹ Rᵀ A
  Eigen::VectorXd answered_;  ///< L⁻¹ Rᵀ b
};

}  // namespace waymark
