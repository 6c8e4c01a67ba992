#include "core/camera/rig_fingerprint.h"

#include "core/base/fingerprint.h"

namespace waymark {

std::string fingerprint(const Rig& rig) {
  Fingerprint hash;
  for (const RigCamera& camera : rig.cameras) {
    const CameraParameters& p = camera.model.parameters();
    hash.add(to_string(p.distortion));
    for (const double value : {p.fu_px, p.fv_px, p.pu_px, p.pv_px}) hash.add(value);
    for (const double value : p.coefficients) hash.add(value);
    hash.add(std::int64_t{p.width_px});
    hash.add(std::int64_t{p.height_px});
    hash.add(std::span<const double>(camera.rig_from_cam.rotation.coeffs().data(), 4));
    hash.add(std::span<const double>(camera.rig_from_cam.translation.data(), 3));
  }
  return hash.hexadecimal();
}

}  // namespace waymark
