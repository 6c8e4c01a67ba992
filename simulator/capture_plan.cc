#include "simulator/capture_plan.h"

#include <algorithm>
#include <cmath>

#include "simulator/random.h"

namespace waymark::simulator {
namespace {

/// Stamp of the first position; any epoch would do, this one looks like a clock's.
constexpr Stamp kStart = std::chrono::seconds(1'700'000'000);

Stamp to_stamp(double seconds) { return Stamp(std::llround(seconds * 1e9)); }

}  // namespace

CapturePlan::CapturePlan(const Scene& scene, const SimulatedRig& rig, int positions, bool moving,
                         double stamp_skew_sigma_s, std::uint64_t seed)
    : rig_(rig.rig),
      way_(scene.trajectory),
      speed_mps_(scene.trajectory.speed_mps),
      step_m_(way_.length_m() / positions),
      moving_(moving) {
  exposures_.reserve(static_cast<std::size_t>(positions) * rig_.cameras.size());
  for (std::size_t position = 0; position < static_cast<std::size_t>(positions); ++position) {
    const double time_s = static_cast<double>(position) * step_m_ / speed_mps_;
    for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
      Random random = Random::of({seed, 5, position, camera});
      const double skew_s = stamp_skew_sigma_s * std::clamp(random.normal(), -3.0, 3.0);
      exposures_.push_back({position, camera, kStart + to_stamp(time_s + skew_s)});
    }
  }
}

Rigid3 CapturePlan::world_from_cam0_after(const Exposure& exposure, double seconds) const {
  if (!moving_) return way_.world_from_cam0(static_cast<double>(exposure.position) * step_m_);
  const double time_s = in_s(exposure.stamp - kStart) + seconds;
  return way_.world_from_cam0(time_s * speed_mps_);
}

Rigid3 CapturePlan::world_from_rig(const Exposure& exposure) const {
  return world_from_cam0(exposure) * rig_.cameras.front().rig_from_cam.inverse();
}

Rigid3 CapturePlan::world_from_cam(const Exposure& exposure) const {
  return world_from_rig(exposure) * rig_.cameras[exposure.camera].rig_from_cam;
}

CameraMotion CapturePlan::motion(const Exposure& exposure) const {
  const Rigid3 cam0_from_cam =
      rig_.cameras.front().rig_from_cam.inverse() * rig_.cameras[exposure.camera].rig_from_cam;
  return [this, exposure, cam0_from_cam](double seconds) {
    return world_from_cam0_after(exposure, seconds) * cam0_from_cam;
  };
}

}  // namespace waymark::simulator
