#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/rig_agreement.h"

namespace waymark {

/// Where the rig was over time, as all cameras but one tell; between frame sets on a cubic with the
/// velocities that the neighbouring sets give, beyond the ends straight on.
class RigPath {
 public:
  RigPath(const CameraTracks& tracks, const Extrinsics& rig_from_cam, double noise_scale,
          int without);

  /// world_from_rig at a frame set; nullopt where the others tell nothing.
  [[nodiscard]] const std::optional<Rigid3>& at(std::size_t instant) const {
    return world_from_rig_[instant];
  }
  /// later_from_now in world axes: what carries the rig's pose at a frame set to `offset_s` after
  /// (before, where negative). nullopt where the path has a gap.
  [[nodiscard]] std::optional<Rigid3> motion(std::size_t instant, double offset_s) const;

  /// Median time between frame sets (s).
  [[nodiscard]] double period_s() const { return period_s_; }
  /// Whether the rig moves smoothly from set to set; images taken at rest here and there tell
  /// nothing of clocks.
  [[nodiscard]] bool moves() const { return moves_; }

 private:
  [[nodiscard]] double gap_s(std::size_t before, std::size_t after) const;
  /// The next frame set with a pose, before (−1) or after (1), unless a gap lies between.
  [[nodiscard]] std::optional<std::size_t> neighbour(std::size_t instant, int step) const;
  /// Per second, world axes, at a frame set with a pose.
  [[nodiscard]] Vector6d velocity(std::size_t instant) const;
  [[nodiscard]] Rigid3 between(std::size_t before, std::size_t after, double share) const;

  std::vector<double> time_s_;
  std::vector<std::optional<Rigid3>> world_from_rig_;
  double period_s_ = 0;
  bool moves_ = false;
};

}  // namespace waymark
