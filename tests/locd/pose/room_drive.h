#pragma once

#include <map>
#include <vector>

#include "locd/frames/frame_synchronizer.h"
#include "locd/pose/localizer.h"
#include "tests/support/room_capture.h"
#include "tests/support/room_map.h"

namespace waymark::test {

/// The room's frame sets, one after the other.
class RoomDrive {
 public:
  explicit RoomDrive(SyntheticRoom room) : room_(std::move(room)) {
    for (const ImageDetections& image : room_.images) images_[image.stamp].push_back(&image);
  }

  [[nodiscard]] SyntheticRoom& room() { return room_; }
  [[nodiscard]] std::size_t size() const { return images_.size(); }

  [[nodiscard]] FrameSetLease set(std::size_t index) const {
    FrameSetLease set;
    set.sequence = index;
    set.expected = static_cast<CameraMask>((1U << room_.rig.cameras.size()) - 1);
    for (const ImageDetections* image : images_.at(room_stamp(static_cast<int>(index)))) {
      const auto camera = static_cast<std::size_t>(image->camera);
      FrameInfo info;
      info.stamp = image->stamp;
      info.quality = StampQuality::replayed;
      set.frames[camera] = Frame(info, {}, image, nullptr, 0);
      set.cameras |= camera_bit(camera);
    }
    return set;
  }

 private:
  SyntheticRoom room_;
  std::map<Stamp, std::vector<const ImageDetections*>> images_;
};

}  // namespace waymark::test
