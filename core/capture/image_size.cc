#include "core/capture/image_size.h"

namespace waymark {

Status check_image_size(ImageSize found, std::optional<ImageSize> expected) {
  if (expected && found != *expected) {
    return fail(ErrorKind::bad_data,
                "the image is {}×{}, rig.yaml says {}×{}; images are never scaled: calibrate at "
                "this size",
                found.width_px, found.height_px, expected->width_px, expected->height_px);
  }
  // The product of what a header may state need not fit.
  if (found.height_px > 0 && found.width_px > kMaxImagePixels / found.height_px) {
    return fail(ErrorKind::bad_data, "{}×{} px; more than 200 megapixels", found.width_px,
                found.height_px);
  }
  return {};
}

}  // namespace waymark
