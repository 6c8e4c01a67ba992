#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/rigid3.h"
#include "mapbuilder/observations/observations.h"

namespace waymark {

struct BundleVariables;

using SizeClassIndex = Index<struct SizeClassKind>;  ///< markers of one stated size

/// Where the variables of the reduced system stand, in blocks of six rows; −1: constant.
struct ReducedLayout {
  int markers = 0;  ///< blocks 0 … markers − 1, one each
  IndexedVector<CameraIndex, int> extrinsics;
  IndexedVector<CameraIndex, int> focal;      ///< fu fv pu pv in the first four rows
  IndexedVector<CameraIndex, int> lens;       ///< the coefficients in the first four rows
  IndexedVector<SizeClassIndex, int> size;    ///< row 0
  IndexedVector<CameraIndex, int> edge_bias;  ///< row 0
  int blocks = 0;
};

/// A residual in sigmas with its derivatives by the blocks it touches.
struct FactorLinearization {
  struct Part {
    int block = 0;
    Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian;
  };
  Eigen::VectorXd residual;
  std::vector<Part> parts;
};

/// A residual on markers and calibration alone, without any rig: a surveyed point or distance, a
/// prior.
class BundleFactor {
 public:
  virtual ~BundleFactor() = default;
  /// Blocks of the reduced system that it touches, rising.
  [[nodiscard]] virtual std::vector<int> blocks() const = 0;
  [[nodiscard]] virtual FactorLinearization linearize(const BundleVariables& at) const = 0;
};

}  // namespace waymark
