#include "mapbuilder/bundle/direction_hold.h"

namespace waymark {
namespace {

/// Of the limit that the direction is measured in: tight against it, loose against rounding.
constexpr double kTightness = 0.01;

class DirectionHold : public KeptFactor {
 public:
  DirectionHold(const KeptLayout& layout, std::vector<RigCamera> stated,
                std::vector<Vector6d> extrinsics, std::vector<Intrinsics> intrinsics)
      : layout_(layout),
        stated_(std::move(stated)),
        extrinsics_(std::move(extrinsics)),
        intrinsics_(std::move(intrinsics)) {}

  [[nodiscard]] std::vector<int> blocks() const override {
    std::vector<int> all;
    for (std::size_t c = 0; c < stated_.size(); ++c) {
      for (const int block : {layout_.extrinsics[c], layout_.focal[c], layout_.lens[c]}) {
        if (block >= 0) all.push_back(block);
      }
    }
    return all;
  }

  [[nodiscard]] KeptLinearization linearize(const JointUnknowns& at) const override {
    KeptLinearization result;
    double along = 0;
    for (std::size_t c = 0; c < stated_.size(); ++c) {
      if (layout_.extrinsics[c] >= 0) {
        // The tangent's own derivative is the identity to within the camera's turn: a degree or
        // two.
        along += extrinsics_[c].dot(at.cameras[c].rig_from_cam.minus(stated_[c].rig_from_cam));
        result.parts.push_back({layout_.extrinsics[c], extrinsics_[c].transpose() / kTightness});
      }
      along +=
          intrinsics_[c].dot(intrinsics_of(at.cameras[c].model) - intrinsics_of(stated_[c].model));
      add_part(layout_.focal[c], intrinsics_[c].head<4>(), result);
      add_part(layout_.lens[c], intrinsics_[c].tail<4>(), result);
    }
    result.residual.resize(1);
    result.residual[0] = along / kTightness;
    return result;
  }

 private:
  static void add_part(int block, const Eigen::Vector4d& weights, KeptLinearization& to) {
    if (block < 0) return;
    Eigen::Matrix<double, Eigen::Dynamic, 6> by_block(1, 6);
    by_block.setZero();
    by_block.leftCols<4>() = weights.transpose() / kTightness;
    to.parts.push_back({block, by_block});
  }

  KeptLayout layout_;
  std::vector<RigCamera> stated_;
  std::vector<Vector6d> extrinsics_;
  std::vector<Intrinsics> intrinsics_;
};

}  // namespace

Intrinsics intrinsics_of(const CameraModel& camera) {
  const CameraParameters& p = camera.parameters();
  Intrinsics all;
  all << p.fu_px, p.fv_px, p.pu_px, p.pv_px, p.coefficients[0], p.coefficients[1],
      p.coefficients[2], p.coefficients[3];
  return all;
}

std::unique_ptr<KeptFactor> direction_hold(const JointProblem& problem,
                                           const std::vector<RigCamera>& stated,
                                           const std::vector<Vector6d>& extrinsics,
                                           const std::vector<Intrinsics>& intrinsics) {
  return std::make_unique<DirectionHold>(problem.layout(), stated, extrinsics, intrinsics);
}

}  // namespace waymark
