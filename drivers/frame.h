#pragma once

#include <cstdint>
#include <utility>

#include "core/capture/detection.h"
#include "core/capture/gray_image.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// How far a frame's stamp can be believed.
enum class StampQuality : std::uint8_t {
  exact,        ///< mid-exposure by the device's own clock
  approximate,  ///< by the device's clock, but where in the exposure it was taken is not known: the
                ///< exposure is automatic or another program changed it, or the driver
                ///< does not say
  arrival,      ///< when the frame arrived, for the device's stamps can't be believed: UNSYNCED
  replayed,     ///< as written in a capture
};

/// Lends its buffers out as frames.
class FrameLender {
 public:
  /// The frame that holds buffer `slot` is destroyed or released. Called from any thread, once per
  /// frame; must not block for long.
  virtual void take_back(std::uint32_t slot) noexcept = 0;

 protected:
  ~FrameLender() = default;
};

/// When and how a frame was taken.
struct FrameInfo {
  Stamp stamp{0};              ///< mid-exposure of the middle row, CLOCK_MONOTONIC
  Stamp arrival{0};            ///< when it was taken from the driver, CLOCK_MONOTONIC
  std::uint64_t sequence = 0;  ///< the driver's own count; a gap tells of frames lost before us
  Stamp exposure{0};           ///< length; 0: not known
  StampQuality quality = StampQuality::exact;
};

/// One camera's image of one instant: a lease on the driver's buffer, given back when the frame is
/// destroyed or moved from. Nothing is copied. The lender outlives its frames.
class Frame {
 public:
  Frame() = default;
  /// `detections` are not null when a capture tells what was found (detections.csv): then `image`
  /// may be empty. Both live as long as the lease.
  Frame(const FrameInfo& info, const GrayView& image, const ImageDetections* detections,
        FrameLender* lender, std::uint32_t slot)
      : info_(info), image_(image), detections_(detections), lender_(lender), slot_(slot) {}

  Frame(Frame&& other) noexcept { swap(other); }
  Frame& operator=(Frame&& other) noexcept {
    Frame taken(std::move(other));
    swap(taken);
    return *this;
  }
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;
  ~Frame() { release(); }

  /// Gives the buffer back before the frame's end; the view is empty from then on.
  void release() noexcept {
    if (lender_ != nullptr) lender_->take_back(slot_);
    lender_ = nullptr;
    image_ = {};
    detections_ = nullptr;
  }

  [[nodiscard]] const FrameInfo& info() const { return info_; }
  [[nodiscard]] Stamp stamp() const { return info_.stamp; }
  /// Sets a corrected stamp (StampGuard).
  void set_stamp(Stamp stamp, StampQuality quality) {
    info_.stamp = stamp;
    info_.quality = quality;
  }

  [[nodiscard]] bool has_image() const { return image_.data != nullptr; }
  [[nodiscard]] const GrayView& image() const { return image_; }
  /// The markers of the image as a capture has them; null: it was not searched yet.
  [[nodiscard]] const ImageDetections* detections() const { return detections_; }

 private:
  void swap(Frame& other) noexcept {
    std::swap(info_, other.info_);
    std::swap(image_, other.image_);
    std::swap(detections_, other.detections_);
    std::swap(lender_, other.lender_);
    std::swap(slot_, other.slot_);
  }

  FrameInfo info_;
  GrayView image_;
  const ImageDetections* detections_ = nullptr;
  FrameLender* lender_ = nullptr;
  std::uint32_t slot_ = 0;
};

}  // namespace waymark
