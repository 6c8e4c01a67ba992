#include "core/camera/rig_fingerprint.h"

#include <algorithm>

#include "core/base/fingerprint.h"
#include "core/camera/lens_kind.h"

namespace waymark {

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
    hash.add(std::span<const double>(camera.rig_from_cam.rotation.coeffs().data(), 4));
    hash.add(std::span<const double>(camera.rig_from_cam.translation.data(), 3));
  }
  return hash.hexadecimal();
}

}  // namespace waymark
