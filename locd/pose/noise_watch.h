#pragma once

#include <span>
#include <vector>

#include "locd/alert.h"
#include "locd/pose/corner_noise.h"
#include "locd/pose/map_index.h"
#include "locd/pose/robust_pose.h"

namespace waymark {

/// Learns how noisy each camera's corners are, set by set, and says where that is unusual.
class NoiseWatch {
 public:
  /// The map must outlive it.
  NoiseWatch(const MapIndex& map, std::size_t cameras);

  /// Before anything was seen (CornerNoise::begin).
  void begin(bool covariances_stated);
  [[nodiscard]] bool begun() const { return noise_.front().begun(); }

  /// One set's corners. `solution` may be null: noise needs no pose.
  void learn(Stamp stamp, std::span<const SetObservation> observations,
             const PoseSolution* solution, const RigPoseSolver& solver, std::vector<Alert>& alerts);

  [[nodiscard]] NoiseSigmas sigmas_px() const;
  /// Whether the camera's newest markers are as noisy as sigmas_px says.
  [[nodiscard]] bool settled(std::size_t camera) const { return noise_[camera].settled(); }

 private:
  void tell(Stamp stamp, std::vector<Alert>& alerts);

  const MapIndex& map_;
  std::vector<CornerNoise> noise_;
  std::vector<char> noisy_;  ///< cameras of which NOISE was said
  std::size_t next_marker_ = 0;
};

}  // namespace waymark
