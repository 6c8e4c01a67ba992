#include "locd/service/camera_check.h"

#include <fmt/ostream.h>

#include <algorithm>

#include "core/base/one_line.h"
#include "drivers/monotonic_clock.h"

namespace waymark {
namespace {

/// A slow camera's first frame takes so long (1–10 s).
constexpr Stamp kPatience = std::chrono::seconds(5);

/// What runs, after the camera gave a frame.
Expected<std::string> try_out(FrameSource& camera) {
  if (auto started = camera.start(); !started) return tl::make_unexpected(started.error());
  auto frame = camera.next(monotonic_now() + kPatience);
  if (!frame) return tl::make_unexpected(frame.error());
  if (!*frame) {
    return fail(ErrorKind::unavailable,
                "runs, but gives no frame within {} s; does it wait for a trigger?",
                std::chrono::duration_cast<std::chrono::seconds>(kPatience).count());
  }
  return camera.describe();
}

Expected<std::string> check(FrameSource& camera, std::optional<int> owner, std::ostream& out) {
  const auto device = camera.inspect();
  if (!device) return tl::make_unexpected(device.error());
  fmt::print(out, "{}: {}\n", camera.name(), in_one_line(device->text));
  if (owner && std::count(device->holders.begin(), device->holders.end(), *owner) > 0) {
    return fmt::format("in use by the running locd (pid {})", *owner);
  }
  auto tried = try_out(camera);
  camera.close();
  return tried;
}

}  // namespace

Status check_cameras(const std::vector<std::unique_ptr<FrameSource>>& cameras,
                     std::optional<int> owner, std::ostream& out) {
  Status all;
  for (const auto& camera : cameras) {
    const auto found = check(*camera, owner, out);
    fmt::print(out, "{}: {}\n", camera->name(),
               in_one_line(found ? *found : found.error().message));
    if (!found && all) {
      all = fail(found.error().kind, "{}: {}", camera->name(), found.error().message);
    }
  }
  return all;
}

}  // namespace waymark
