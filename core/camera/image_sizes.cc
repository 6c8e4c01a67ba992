#include "core/camera/image_sizes.h"

namespace waymark {

Status check_image_sizes(const Rig& rig, const std::string& name) {
  std::int64_t pixels = 0;
  for (const RigCamera& camera : rig.cameras) {
    const CameraParameters& size = camera.model.parameters();
    pixels += std::int64_t{size.width_px} * size.height_px;
    if (pixels > kMaxRigPixels) {
      return fail(ErrorKind::bad_data,
                  "{}: {}: with {}×{} px the images have more than {} megapixels in all; state the "
                  "resolution in pixels",
                  name, camera.name, size.width_px, size.height_px, kMaxRigPixels / 1'000'000);
    }
  }
  return {};
}

}  // namespace waymark
