#include "mapbuilder/mapping/direction_hold.h"

namespace waymark {
namespace {

/// Of the limit that the direction is measured in: tight against it, loose against rounding.
constexpr double kTightness = 0.01;

class DirectionHold : public KeptFactor {
 public:
  DirectionHold(const KeptLayout& layout, std::vector<RigCamera> stated,
                std::vector<Vector6d> extrinsics, std::vector<Eigen::Vector2d> focal)
      : layout_(layout),
        stated_(std::move(stated)),
        extrinsics_(std::move(extrinsics)),
        focal_(std::move(focal)) {}

  [[nodiscard]] std::vector<int> blocks() const override {
    std::vector<int> all;
    for (std::size_t c = 0; c < stated_.size(); ++c) {
      if (layout_.extrinsics[c] >= 0) all.push_back(layout_.extrinsics[c]);
      if (layout_.focal[c] >= 0) all.push_back(layout_.focal[c]);
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
      if (layout_.focal[c] >= 0) {
        const CameraParameters& now = at.cameras[c].model.parameters();
        const CameraParameters& then = stated_[c].model.parameters();
        along += focal_[c].dot(Eigen::Vector2d(now.fu_px - then.fu_px, now.fv_px - then.fv_px));
        Eigen::Matrix<double, Eigen::Dynamic, 6> by_focal(1, 6);
        by_focal.setZero();
        by_focal.leftCols<2>() = focal_[c].transpose() / kTightness;
        result.parts.push_back({layout_.focal[c], by_focal});
      }
    }
    result.residual.resize(1);
    result.residual[0] = along / kTightness;
    return result;
  }

 private:
  KeptLayout layout_;
  std::vector<RigCamera> stated_;
  std::vector<Vector6d> extrinsics_;
  std::vector<Eigen::Vector2d> focal_;
};

}  // namespace

std::unique_ptr<KeptFactor> direction_hold(const JointProblem& problem,
                                           const std::vector<RigCamera>& stated,
                                           const std::vector<Vector6d>& extrinsics,
                                           const std::vector<Eigen::Vector2d>& focal) {
  return std::make_unique<DirectionHold>(problem.layout(), stated, extrinsics, focal);
}

}  // namespace waymark
