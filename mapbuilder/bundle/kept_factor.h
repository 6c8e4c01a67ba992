#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/rigid3.h"

namespace waymark {

struct JointUnknowns;

/// Where the kept unknowns of a joint adjustment stand, in blocks of six rows; −1: not free.
struct KeptLayout {
  int markers = 0;              ///< blocks 0 … markers − 1, one each
  std::vector<int> extrinsics;  ///< per camera
  std::vector<int> focal;       ///< per camera: fu fv pu pv in the first four rows
  std::vector<int> lens;        ///< per camera: the coefficients in the first four rows
  std::vector<int> size;        ///< per size class: row 0
  std::vector<int> edge_bias;   ///< per camera: row 0
  int blocks = 0;
};

/// A residual in sigmas with its derivatives by the kept blocks it touches.
struct KeptLinearization {
  struct Part {
    int block = 0;
    Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian;
  };
  Eigen::VectorXd residual;
  std::vector<Part> parts;
};

/// A residual on markers and calibration alone, without any rig: a surveyed point or distance, a
/// prior.
class KeptFactor {
 public:
  virtual ~KeptFactor() = default;
  /// Kept blocks it touches, rising.
  [[nodiscard]] virtual std::vector<int> blocks() const = 0;
  [[nodiscard]] virtual KeptLinearization linearize(const JointUnknowns& at) const = 0;
};

}  // namespace waymark
