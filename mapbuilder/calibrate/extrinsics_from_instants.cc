#include "mapbuilder/calibrate/extrinsics_from_instants.h"

#include <algorithm>

#include "mapbuilder/diagnosis/rig_fit.h"

namespace waymark {
namespace {

/// Fewer may be two wrong places that agree by chance.
constexpr std::size_t kFewestInstants = 3;

/// Places are surer of the noise in their corners than of the map and lens that they were told by.
constexpr double kNoiseScale = 5.0;

using Placed = std::vector<std::optional<Rigid3>>;

/// The tracks of cameras that are placed, and of one more.
CameraTracks tracks_of_placed(CameraTracks tracks, const Placed& placed, std::size_t camera) {
  for (CameraTracks::Instant& instant : tracks.instants) {
    for (std::size_t k = 0; k < placed.size(); ++k) {
      if (!placed[k] && k != camera) instant.places[k].reset();
    }
  }
  return tracks;
}

/// Instants that a camera shares with placed ones.
std::size_t shared_instants(const CameraTracks& tracks, const Placed& placed, std::size_t camera) {
  const auto is_shared = [&](const CameraTracks::Instant& instant) {
    if (!instant.places[camera]) return false;
    for (std::size_t k = 0; k < placed.size(); ++k) {
      if (placed[k] && instant.places[k]) return true;
    }
    return false;
  };
  return static_cast<std::size_t>(
      std::count_if(tracks.instants.begin(), tracks.instants.end(), is_shared));
}

/// The camera without a place that shares most; nullopt: none shares enough.
std::optional<std::size_t> next_camera(const CameraTracks& tracks, const Placed& placed) {
  std::optional<std::size_t> next;
  std::size_t most = kFewestInstants - 1;
  for (std::size_t k = 0; k < placed.size(); ++k) {
    const std::size_t shared = placed[k] ? 0 : shared_instants(tracks, placed, k);
    if (shared <= most) continue;
    most = shared;
    next = k;
  }
  return next;
}

Extrinsics or_identity(const Placed& placed) {
  Extrinsics all;
  for (const auto& place : placed) all.push_back(place.value_or(Rigid3{}));
  return all;
}

}  // namespace

std::vector<std::optional<Rigid3>> extrinsics_from_instants(const CameraTracks& tracks) {
  Placed placed(tracks.cameras.size());
  if (placed.empty()) return placed;
  placed.front() = Rigid3{};
  while (const auto camera = next_camera(tracks, placed)) {
    const CameraTracks known = tracks_of_placed(tracks, placed, *camera);
    RigFit fit(known, or_identity(placed));
    fit.set_noise_scale(kNoiseScale);
    placed[*camera] = fit.place_by_others(known, *camera, fit.all());
    if (!placed[*camera]) break;
    const Extrinsics together = fit.fit(known, or_identity(placed), FreeCameras::all(), fit.all());
    for (std::size_t k = 1; k < placed.size(); ++k) {
      if (placed[k]) placed[k] = together[k];
    }
  }
  return placed;
}

}  // namespace waymark
