#include "mapbuilder/bundle/constant_direction.h"

#include "mapbuilder/bundle/bundle_variables.h"

namespace waymark {
namespace {

/// Of the limit that the direction is measured in: tight against it, loose against rounding.
constexpr double kTightness = 0.01;

class DirectionFactor : public BundleFactor {
 public:
  DirectionFactor(const ReducedLayout& layout, const IndexedVector<CameraIndex, RigCamera>& stated,
                  const ConstantDirection& direction)
      : layout_(layout), stated_(stated), direction_(direction) {}

  [[nodiscard]] std::vector<int> blocks() const override {
    std::vector<int> all;
    for (const CameraIndex c : stated_.indices()) {
      for (const int block : {layout_.extrinsics[c], layout_.focal[c], layout_.lens[c]}) {
        if (block >= 0) all.push_back(block);
      }
    }
    return all;
  }

  [[nodiscard]] FactorLinearization linearize(const BundleVariables& at) const override {
    FactorLinearization result;
    double along = 0;
    for (const CameraIndex c : stated_.indices()) {
      if (layout_.extrinsics[c] >= 0) {
        // The tangent's own derivative is the identity to within the camera's turn: a degree or
        // two.
        along +=
            direction_.extrinsics[c].dot(at.cameras[c].rig_from_cam.minus(stated_[c].rig_from_cam));
        result.parts.push_back(
            {layout_.extrinsics[c], direction_.extrinsics[c].transpose() / kTightness});
      }
      along += direction_.intrinsics[c].dot(intrinsics_of(at.cameras[c].model.parameters()) -
                                            intrinsics_of(stated_[c].model.parameters()));
      add_intrinsics(c, result);
    }
    result.residual.resize(1);
    result.residual[0] = along / kTightness;
    return result;
  }

 private:
  void add_intrinsics(CameraIndex camera, FactorLinearization& to) const {
    for (const int block : {layout_.focal[camera], layout_.lens[camera]}) {
      if (block < 0) continue;
      Eigen::Matrix<double, Eigen::Dynamic, 6> by_block(1, 6);
      by_block.setZero();
      for (int k = 0; k < kIntrinsicNumbers; ++k) {
        const int row = layout_.row_of(camera, k) - 6 * block;
        if (row >= 0 && row < 6) by_block(0, row) = direction_.intrinsics[camera][k] / kTightness;
      }
      to.parts.push_back({block, by_block});
    }
  }

  ReducedLayout layout_;
  IndexedVector<CameraIndex, RigCamera> stated_;
  ConstantDirection direction_;
};

}  // namespace

std::unique_ptr<BundleFactor> direction_factor(const ReducedLayout& layout,
                                               const IndexedVector<CameraIndex, RigCamera>& stated,
                                               const ConstantDirection& direction) {
  return std::make_unique<DirectionFactor>(layout, stated, direction);
}

}  // namespace waymark
