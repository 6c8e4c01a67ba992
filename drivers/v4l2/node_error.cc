#include "drivers/v4l2/node_error.h"

#include <fmt/ranges.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace waymark {
namespace {

std::string busy(const VideoNode& node) {
  const std::vector<DeviceHolder> holders = node.holders();
  if (holders.empty()) {
    return fmt::format("another program uses it; `sudo fuser -v {}` names it", node.path());
  }
  std::vector<std::string> others;
  for (const DeviceHolder& holder : holders) {
    if (holder.pid == ::getpid()) continue;
    others.push_back(fmt::format("{} (pid {})", holder.program, holder.pid));
  }
  if (others.empty()) {
    return "this program uses it already; do two [[camera]] blocks name one device?";
  }
  return fmt::format("{} uses it; end that first", fmt::join(others, ", "));
}

}  // namespace

Error node_error(const VideoNode& node, std::string_view what, int error_number) {
  const auto say = [&](ErrorKind kind, std::string_view why) {
    return Error{kind, fmt::format("{}: {}: {}", node.path(), what, why)};
  };
  switch (error_number) {
    case ENODEV:
    case ENXIO:
      return say(ErrorKind::unavailable, "the device is gone; plug it in again");
    case EBUSY:
      return say(ErrorKind::unavailable, busy(node));
    case ENOSPC:
      return say(ErrorKind::unavailable,
                 "not enough USB bandwidth; plug the camera into another controller, or lower fps");
    case EACCES:
    case EPERM:
      return say(ErrorKind::permission, "not allowed; the user must be in group video");
    default:
      return say(ErrorKind::io, std::error_code(error_number, std::generic_category()).message());
  }
}

bool says_absent(int error_number) {
  // ENODATA: of frame rates and crops, where the present input has none.
  return error_number == EINVAL || error_number == ENOTTY || error_number == ENODATA;
}

}  // namespace waymark
