#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/range.h"
#include "core/capture/detection.h"
#include "core/capture/gray_image.h"
#include "locd/alert.h"
#include "locd/camera_mask.h"
#include "locd/frames/frame_synchronizer.h"

namespace waymark {

/// When an image is of no use. Grey levels 0–255.
struct ImageHealthOptions {
  /// So many in a row that equal the one before: frozen; that equal an older one: stale. Bit for
  /// bit: noise alone makes images differ. (2–100)
  int identical_images = 3;
  int dark_grey = 16;     ///< 99 % of the pixels are darker: dark (1–100)
  int bright_grey = 250;  ///< and brighter, for saturated_share of them: saturated (100–255)
  double saturated_share = 0.75;  ///< (0.1–1) a lamp or the sky fills less
  /// 99.5 % of the differences between pixels 4 px apart are smaller: obscured, for even a wall has
  /// edges. (1–50)
  int edge_grey = 10;
  /// What cameras gave before is not known, for they ran on while the program was started anew: the
  /// first image of one may be an old one, until it has given another.
  bool doubt_first_images = false;
  int sets_to_raise = 3;  ///< dark, saturated, obscured so often in a row (1–100)
  int sets_to_clear = 3;  ///< (1–100)

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Recognizes images that are frozen, stale (old buffers in turn), dark, saturated or covered.
/// Looks at every 16th pixel, and at all of them for the comparison with earlier images. One per
/// rig. No allocation.
class ImageHealth {
 public:
  /// The options are valid (checked).
  ImageHealth(std::size_t cameras, const ImageHealthOptions& options = {});

  /// Images of a camera that its next one is compared with: the last different ones.
  static constexpr std::size_t kRemembered = 16;

  /// All that a set has, by images or detections; the cameras whose frames can be used.
  CameraMask look(const FrameSetLease& set, std::vector<Alert>& alerts);
  /// One camera's next image; says what began or ended.
  void look(std::size_t camera, const GrayView& image, Stamp stamp, std::vector<Alert>& alerts);
  /// The same where detections come in place of an image: frozen and stale are told by them. Of
  /// frames without any marker nothing is.
  void look(std::size_t camera, std::span<const Detection> detections, Stamp stamp,
            std::vector<Alert>& alerts);

  /// Takes over which images the same cameras gave before, so that one of them is known when it
  /// comes again; faults begin anew, with the next image.
  void remember_images_of(const ImageHealth& before);

  /// Cameras that can't be used now.
  [[nodiscard]] CameraMask unhealthy() const { return unhealthy_; }
  /// Cameras whose newest image is one of their last, or a first one that is doubted: it tells
  /// nothing of now, whether or not that is a fault yet.
  [[nodiscard]] CameraMask repeated() const { return repeated_; }

 private:
  struct Fault {
    int sets = 0;  ///< in a row
    int healthy = 0;
    bool raised = false;
  };
  static constexpr std::size_t kFaults = 5;
  /// What a camera gave.
  struct Images {
    std::array<std::uint64_t, kRemembered> hashes{};  ///< of different images, a ring
    std::size_t different = 0;                        ///< put into it, ever
    std::uint64_t last_hash = 0;
    int identical = 0;  ///< in a row, this one included
    int older = 0;      ///< in a row that equal an older one than the last
  };
  struct Camera {
    Images images;
    std::array<Fault, kFaults> faults;  ///< by kKinds
  };
  void compare(std::size_t camera, std::uint64_t hash, Stamp stamp, std::vector<Alert>& alerts);
  void sum_up(std::size_t camera);
  void note(std::size_t camera, std::size_t fault, bool present, int sets_to_raise, Stamp stamp,
            std::vector<Alert>& alerts);

  ImageHealthOptions options_;
  std::vector<Camera> cameras_;
  CameraMask unhealthy_ = 0;
  CameraMask repeated_ = 0;
};

}  // namespace waymark
