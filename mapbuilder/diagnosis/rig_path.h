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

  /// How far the path may miss the rig between frame sets, as a motion whose acceleration is white
  /// noise would: variances per s³ of wander_s3(), as frame sets lie off the cubic through their
  /// neighbours.
  struct Wander {
    double position_m2_per_s3 = 0;
    double rotation_rad2_per_s3 = 0;
  };
  [[nodiscard]] const Wander& wander() const { return wander_; }
  /// What has piled up at `offset_s` after a frame set (s³): G³ s³ (1 − s)³ at the share s between
  /// two sets that are G apart, t³ at t beyond the last; 0 at sets.
  [[nodiscard]] double wander_s3(std::size_t instant, double offset_s) const;

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
  /// The sets that a moment lies between or, beyond the ends, next to; with its share of the time
  /// from one to the other.
  struct Span {
    std::size_t before;
    std::size_t after;
    double share;
  };
  [[nodiscard]] std::optional<Span> span_of(double when_s) const;
  [[nodiscard]] std::optional<Vector6d> off_the_cubic(std::size_t instant) const;
  void measure_wander();

  std::vector<double> time_s_;
  std::vector<std::optional<Rigid3>> world_from_rig_;
  double period_s_ = 0;
  bool moves_ = false;
  Wander wander_;
};

}  // namespace waymark
