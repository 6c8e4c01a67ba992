#include "core/camera/rig_fingerprint.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/fingerprint.h"
#include "core/camera/lens_kind.h"

namespace waymark {
namespace {

/// What writing, inverting and chaining transforms leaves in the last bits is no other calibration.
std::int64_t rounded(double value) { return std::llround(1e9 * value); }

}  // namespace

std::string fingerprint(const Rig& rig) {
  Fingerprint hash;
  for (const RigCamera& camera : rig.cameras) {
    const CameraParameters& p = camera.model.parameters();
    hash.add(to_string(p.distortion));
    for (const double value : {p.fu_px, p.fv_px, p.pu_px, p.pv_px}) hash.add(value);
    // Four at least, as there were before kinds had other numbers of them.
    const auto count = static_cast<std::size_t>(std::max(4, lens_kind(p.distortion).count()));
    hash.add(std::span<const double>(p.coefficients.data(), count));
    hash.add(std::int64_t{p.width_px});
    hash.add(std::int64_t{p.height_px});
    if (p.valid_radius_px) hash.add(*p.valid_radius_px);
    const Eigen::Matrix3d rotation = camera.rig_from_cam.rotation.toRotationMatrix();
    for (const double value : rotation.reshaped()) hash.add(rounded(value));
    for (const double value : camera.rig_from_cam.translation) hash.add(rounded(value));
  }
  return hash.hexadecimal();
}

}  // namespace waymark
