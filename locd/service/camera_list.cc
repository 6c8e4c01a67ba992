#include "locd/service/camera_list.h"

#include <fmt/ostream.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "core/base/one_line.h"
#include "drivers/v4l2/capture_format.h"
#include "drivers/v4l2/device_lookup.h"

namespace waymark {
namespace {

/// Not an int: of USB cameras both sides come as 16 bits.
std::int64_t area_px(const OfferedFormat& format) {
  return std::int64_t{format.width_px} * format.height_px;
}

/// The format to suggest: the largest image, in the best format that it comes in; null: none that
/// is understood.
const OfferedFormat* best_of(const std::vector<OfferedFormat>& formats) {
  const auto best =
      std::max_element(formats.begin(), formats.end(),
                       [](const auto& a, const auto& b) { return area_px(a) < area_px(b); });
  return best == formats.end() ? nullptr : &*best;
}

/// Prints the blocks, which are numbered as they come.
class BlockPrinter {
 public:
  explicit BlockPrinter(std::ostream& out) : out_(out) {}

  /// False when the camera gets none; why is printed instead.
  bool print(const char* driver, const std::string& identity,
             const std::vector<OfferedFormat>& formats) {
    const OfferedFormat* const format = best_of(formats);
    if (identity.empty() || !is_plain(identity)) {
      fmt::print(out_, "# can't be told from another camera: plug it in elsewhere\n\n");
      return false;
    }
    if (format == nullptr) {
      fmt::print(out_, "# none of which is understood by driver \"{}\"\n\n", driver);
      return false;
    }
    // In single quotes: names of libcamera's have backslashes.
    fmt::print(out_,
               "[[camera]]\nname = \"cam{}\"\ndriver = \"{}\"\ndevice = '{}'\nformat = \"{}\"",
               number_++, driver, identity, format->pixels->name);
    if (format->width_px > 0) fmt::print(out_, "  # {}×{}", format->width_px, format->height_px);
    fmt::print(out_, "\n# fps = 30, exposure_us = 2000, gain = …: see /etc/locd/locd.toml\n\n");
    return true;
  }

 private:
  std::ostream& out_;
  std::size_t number_ = 0;
};

}  // namespace

Status list_cameras(VideoSystem& system, const std::vector<LibcameraCamera>& by_libcamera,
                    std::ostream& out) {
  const auto devices = find_cameras(system);
  // What devices say of themselves stays within its line, and out of the terminal's commands.
  constexpr std::size_t kMaxOffered = 4000;
  const auto describe = [&](const std::string& what, const std::string& offered) {
    fmt::print(out, "# {}\n# offers {}\n", in_one_line(what), in_one_line(offered, kMaxOffered));
  };
  BlockPrinter blocks(out);
  std::set<std::string> covered;
  for (const VideoDevice& device : devices) {
    const auto node = system.open(device.node);
    if (!node) {
      fmt::print(out, "# {}\n\n", in_one_line(node.error().message));
      continue;
    }
    describe(name_of(device), offered_formats(**node));
    if (blocks.print("v4l2", identity_among(device, devices), understood_formats(**node))) {
      covered.insert(device.node);
    }
  }
  for (const LibcameraCamera& camera : by_libcamera) {
    const bool has_block = std::any_of(camera.nodes.begin(), camera.nodes.end(),
                                       [&](const auto& node) { return covered.contains(node); });
    if (has_block) continue;
    describe(fmt::format("{} ({}), by libcamera", camera.id, camera.model), camera.offered);
    blocks.print("libcamera", camera.id, camera.understood);
  }
  if (!devices.empty() || !by_libcamera.empty()) return {};
  return fail(ErrorKind::unavailable,
              "no camera is plugged in, as far as V4L2 and libcamera (where it is installed) know");
}

}  // namespace waymark
