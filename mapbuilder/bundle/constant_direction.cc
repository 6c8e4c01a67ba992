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
      along += direction_.intrinsics[c].dot(intrinsics_of(at.cameras[c].model) -
                                            intrinsics_of(stated_[c].model));
      add_part(layout_.focal[c], direction_.intrinsics[c].head<4>(), result);
      add_part(layout_.lens[c], direction_.intrinsics[c].tail<4>(), result);
    }
    result.residual.resize(1);
    result.residual[0] = along / kTightness;
    return result;
  }

 private:
  static void add_part(int block, const Eigen::Vector4d& weights, FactorLinearization& to) {
    if (block < 0) return;
    Eigen::Matrix<double, Eigen::Dynamic, 6> by_block(1, 6);
    by_block.setZero();
    by_block.leftCols<4>() = weights.transpose() / kTightness;
    to.parts.push_back({block, by_block});
  }

  ReducedLayout layout_;
  IndexedVector<CameraIndex, RigCamera> stated_;
  ConstantDirection direction_;
};

}  // namespace

Intrinsics intrinsics_of(const CameraModel& camera) {
  const CameraParameters& p = camera.parameters();
  Intrinsics all;
  all << p.fu_px, p.fv_px, p.pu_px, p.pv_px, p.coefficients[0], p.coefficients[1],
      p.coefficients[2], p.coefficients[3];
  return all;
}

std::unique_ptr<BundleFactor> direction_factor(const ReducedLayout& layout,
                                               const IndexedVector<CameraIndex, RigCamera>& stated,
                                               const ConstantDirection& direction) {
  return std::make_unique<DirectionFactor>(layout, stated, direction);
}

}  // namespace waymark
