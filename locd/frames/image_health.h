#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/capture/gray_image.h"
#include "locd/alert.h"
#include "locd/camera_mask.h"

namespace waymark {

/// When an image is of no use. Grey levels 0–255.
struct ImageHealthOptions {
  int identical_images = 3;  ///< bit for bit: frozen; noise alone makes images differ (2–100)
  int dark_grey = 16;        ///< 99 % of the pixels are darker: dark (1–100)
  int bright_grey = 250;     ///< and brighter, for saturated_share of them: saturated (100–255)
  double saturated_share = 0.75;  ///< (0.1–1) a lamp or the sky fills less
  /// 99.5 % of the differences between pixels 4 px apart are smaller: obscured, for even a wall has
  /// edges. (1–50)
  int edge_grey = 10;
  int sets_to_raise = 3;  ///< dark, saturated, obscured so often in a row (1–100)
  int sets_to_clear = 3;  ///< (1–100)
};

/// Recognizes images that are frozen, dark, saturated or covered. Looks at every 16th pixel, and at
/// all of them for the comparison with the last image. One per rig. No allocation.
class ImageHealth {
 public:
  ImageHealth(std::size_t cameras, const ImageHealthOptions& options = {});

  /// One camera's next image; says what began or ended.
  void look(std::size_t camera, const GrayView& image, Stamp stamp, std::vector<Alert>& alerts);

  /// Cameras that can't be used now.
  [[nodiscard]] CameraMask unhealthy() const { return unhealthy_; }

 private:
  struct Fault {
    int sets = 0;  ///< in a row
    int healthy = 0;
    bool raised = false;
  };
  struct Camera {
    std::uint64_t hash = 0;
    int identical = 0;
    std::array<Fault, 4> faults;  ///< frozen, dark, saturated, obscured
  };
  void note(std::size_t camera, std::size_t fault, bool present, int sets_to_raise, Stamp stamp,
            std::vector<Alert>& alerts);

  ImageHealthOptions options_;
  std::vector<Camera> cameras_;
  CameraMask unhealthy_ = 0;
};

}  // namespace waymark
