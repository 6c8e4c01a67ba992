#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/stamp.h"
#include "locd/pose/evidence.h"
#include "locd/pose/map_index.h"

namespace waymark {

/// Learns what calibrations err by while the vehicle drives: each camera's place, focal length,
/// principal point, first coefficient, clock and read-out. A Kalman filter that begins with the
/// stated sigmas, lets them walk, and takes evidence block by block. Sizes of prints and the map's
/// modes are considered, not learnt: the map stays as it is. What a marker errs by on its own
/// counts as often as its marker was seen in counted sets before, so that the same marker seen
/// again is no new truth. Holds its memory: nothing is allocated after it was made.
class CalibrationFilter {
 public:
  /// The map must outlive it.
  CalibrationFilter(const CalibrationPrior& stated, const MapIndex& map);

  /// Takes a block of evidence that ended at `stamp`. False: it was left out, for it is further
  /// from what is known than its covariance allows (once in a thousand where all is well).
  bool take(const Evidence::System& block, Stamp stamp);

  /// Forgets what was learnt.
  void reset();

  /// As stated until something was learnt. Numbers more than three stated sigmas off are no errors
  /// of a calibration: then, too, it is as stated.
  [[nodiscard]] const CalibrationPrior& known() const { return applied_ ? learnt_ : stated_; }
  /// Blocks that were taken.
  [[nodiscard]] int blocks() const { return blocks_; }

 private:
  using Modes = Eigen::Matrix<double, 6, kMapModes>;
  struct Seen {
    std::size_t marker = 0;
    Eigen::Index at = 0;  ///< in the block
    Matrix6d root;
  };
  void walk(Stamp stamp);
  void take_roots(const Evidence::System& block);
  /// Information and evidence of a block on what is learnt and on the modes, the markers' own
  /// errors eliminated.
  [[nodiscard]] bool reduce(const Evidence::System& block);
  [[nodiscard]] bool update();
  [[nodiscard]] bool within_reason() const;

  CalibrationPrior stated_;
  CalibrationPrior learnt_;
  const MapIndex& map_;
  std::vector<int> counted_;  ///< sets in which each marker was seen
  Stamp last_{0};
  int blocks_ = 0;
  bool applied_ = false;
  std::vector<Seen> seen_;
  // Each as large as it may become; the upper left part is used.
  Eigen::MatrixXd own_information_;  ///< of markers' own errors, in units of their sigmas; I added
  Eigen::MatrixXd crossed_;          ///< between those and what is shared
  Eigen::VectorXd own_evidence_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd evidence_;
  Eigen::MatrixXd innovation_;  ///< covariance, then its factor
  Eigen::MatrixXd gain_;
  Eigen::MatrixXd left_;
  Eigen::MatrixXd product_;
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd step_;
  Eigen::VectorXd mean_;
};

}  // namespace waymark
