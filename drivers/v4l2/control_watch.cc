#include "drivers/v4l2/control_watch.h"

#include <fmt/format.h>

namespace waymark {
namespace {

std::string name_of(std::uint32_t id) {
  switch (id) {
    case V4L2_CID_EXPOSURE_AUTO:
      return "automatic exposure";
    case V4L2_CID_EXPOSURE_AUTO_PRIORITY:
      return "exposure priority";
    case V4L2_CID_EXPOSURE_ABSOLUTE:
      return "exposure";
    case V4L2_CID_GAIN:
    case V4L2_CID_ANALOGUE_GAIN:
      return "gain";
    case V4L2_CID_AUTOGAIN:
      return "automatic gain";
    case V4L2_CID_FOCUS_AUTO:
      return "automatic focus";
    case V4L2_CID_FOCUS_ABSOLUTE:
      return "focus";
    case V4L2_CID_AUTO_WHITE_BALANCE:
      return "automatic white balance";
    case V4L2_CID_WHITE_BALANCE_TEMPERATURE:
      return "white balance";
    case V4L2_CID_POWER_LINE_FREQUENCY:
      return "power line frequency";
    default:
      return fmt::format("control {:#x}", id);
  }
}

}  // namespace

void ControlWatch::begin(std::vector<HeldControl> held, Stamp now) {
  held_ = std::move(held);
  due_ = now + kPeriod;
  changed_.clear();
}

void ControlWatch::look(VideoNode& node, Stamp now) {
  if (now < due_) return;
  due_ = now + kPeriod;
  changed_.clear();
  for (const HeldControl& held : held_) {
    v4l2_control control{held.id, 0};
    if (node.request(VIDIOC_G_CTRL, &control) != 0 || control.value == held.value) continue;
    if (changed_.empty()) {
      changed_ = fmt::format("{} was set from {} to {} by another program; it is set again",
                             name_of(held.id), held.value, control.value);
    }
    control.value = held.value;
    // Whether it took the value, the next look finds out.
    (void)node.request(VIDIOC_S_CTRL, &control);
  }
}

}  // namespace waymark
