#include "locd/pose/noise_watch.h"

#include <array>
#include <optional>

namespace waymark {
namespace {

/// Markers of a camera that tell of its noise, per set.
constexpr std::size_t kNoiseMarkers = 8;

}  // namespace

NoiseWatch::NoiseWatch(const MapIndex& map, std::size_t cameras)
    : map_(map), noise_(cameras), noisy_(cameras, 0) {}

void NoiseWatch::begin(bool covariances_stated) {
  for (CornerNoise& noise : noise_) noise.begin(covariances_stated);
}

NoiseSigmas NoiseWatch::sigmas_px() const {
  NoiseSigmas sigmas{};
  for (std::size_t c = 0; c < noise_.size(); ++c) sigmas[c] = noise_[c].sigma_px();
  return sigmas;
}

void NoiseWatch::learn(Stamp stamp, std::span<const SetObservation> observations,
                       const PoseSolution* solution, const RigPoseSolver& solver,
                       std::vector<Alert>& alerts) {
  std::array<std::size_t, kMaxCameras> taken{};
  const std::size_t count = observations.size();
  for (std::size_t i = 0; i < count; ++i) {
    // By turns, where there are many.
    const SetObservation& o = observations[(next_marker_ + i) % count];
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    if (taken[camera] == kNoiseMarkers) continue;
    std::optional<Rigid3> near;
    if (solution != nullptr && o.inlier) {
      near = solver.cam_from_rig(camera) * solution->world_from_rig.inverse() *
             map_.marker(o.map_index).world_from_marker;
    }
    const auto left = left_by_own_pose(o, solver.model(camera), near, noise_[camera].sigma_px());
    if (!left) continue;
    noise_[camera].add(*left);
    ++taken[camera];
  }
  next_marker_ += kNoiseMarkers;
  for (std::size_t c = 0; c < noise_.size(); ++c) {
    if (taken[c] > 0) noise_[c].update();
  }
  tell(stamp, alerts);
}

void NoiseWatch::tell(Stamp stamp, std::vector<Alert>& alerts) {
  for (std::size_t c = 0; c < noise_.size(); ++c) {
    const bool noisy = noise_[c].unusual();
    if (noisy == (noisy_[c] != 0)) continue;
    noisy_[c] = noisy ? 1 : 0;
    Alert alert;
    alert.kind = AlertKind::corners_noisy;
    alert.raised = noisy;
    alert.stamp = stamp;
    alert.camera = static_cast<int>(c);
    alert.value = noise_[c].total_px();
    alerts.push_back(alert);
  }
}

}  // namespace waymark
