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
  /// fu fv pu pv in the first four rows, the seventh and eighth coefficient in the others.
  IndexedVector<CameraIndex, int> focal;
  IndexedVector<CameraIndex, int> lens;       ///< the first six coefficients
  IndexedVector<SizeClassIndex, int> size;    ///< row 0
  IndexedVector<CameraIndex, int> edge_bias;  ///< row 0
  int blocks = 0;
  int coefficients = kMaxCoefficients;  ///< of each lens vary at most, the first ones

  /// Row of one of the intrinsics (in the order of IntrinsicsVector); −1 where it is
  /// constant.
  [[nodiscard]] int row_of(CameraIndex camera, int number) const {
    if (number >= 4 + coefficients) return -1;
    const bool in_lens = number >= 4 && number < 4 + 6;
    const int block = in_lens ? lens[camera] : focal[camera];
    if (block < 0) return -1;
    return 6 * block + (in_lens ? number - 4 : number < 4 ? number : number - 6);
  }
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
