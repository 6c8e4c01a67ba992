#include "drivers/v4l2/camera_controls.h"

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "drivers/v4l2/node_error.h"

namespace waymark {
namespace {

/// V4L2_CID_EXPOSURE_ABSOLUTE counts in these.
constexpr double kExposureUnit_us = 100;

constexpr std::string_view kIsAutomatic =
    "exposure is automatic: stamps are off by up to half of it; set exposure_us";
constexpr std::string_view kStaysAutomatic =
    "automatic exposure can't be switched off: stamps are off by up to half of it";

struct Range {
  std::uint32_t id = 0;
  double low = 0;
  double high = 0;
  double step = 1;
};

/// One device's controls, as far as they are there.
class ControlPanel {
 public:
  explicit ControlPanel(VideoNode& node) : node_(node) {}

  /// The first of several that the device has; nullopt: it has none.
  [[nodiscard]] Expected<std::optional<Range>> find(std::initializer_list<std::uint32_t> ids) {
    for (const std::uint32_t id : ids) {
      v4l2_queryctrl query{};
      query.id = id;
      const int failed = node_.request(VIDIOC_QUERYCTRL, &query);
      if (failed != 0 && !says_absent(failed)) return cannot("ask for a control", failed);
      if (failed != 0 || (query.flags & V4L2_CTRL_FLAG_DISABLED) != 0) continue;
      return Range{id, static_cast<double>(query.minimum), static_cast<double>(query.maximum),
                   std::max(1.0, static_cast<double>(query.step))};
    }
    return std::nullopt;
  }

  /// nullopt: it has none, or none that can be read.
  [[nodiscard]] Expected<std::optional<int>> read(std::uint32_t id) {
    v4l2_control control{};
    control.id = id;
    const int failed = node_.request(VIDIOC_G_CTRL, &control);
    if (failed == 0) return control.value;
    if (says_absent(failed) || failed == EACCES) return std::nullopt;
    return cannot("read a control", failed);
  }

  /// Whether the device has it at `value` now. A device that is gone is an error, one that refuses
  /// is not.
  [[nodiscard]] Expected<bool> write(std::uint32_t id, int value) {
    v4l2_control control{};
    control.id = id;
    control.value = value;
    const int failed = node_.request(VIDIOC_S_CTRL, &control);
    const bool refused = failed == EINVAL || failed == ERANGE || failed == EACCES;
    if (failed != 0 && !refused) return cannot("set a control", failed);
    const auto now = read(id);
    if (!now) return tl::make_unexpected(now.error());
    if (*now == value) hold(id, value);
    return *now == value;
  }

  /// Sets `value` of whatever `key` names in locd.toml to the next step, by the first of `ids` that
  /// the device has; what it has then.
  Expected<double> set(std::string_view key, std::initializer_list<std::uint32_t> ids, double value,
                       double unit) {
    const auto found = find(ids);
    if (!found) return tl::make_unexpected(found.error());
    const std::optional<Range>& range = *found;
    if (!range) {
      return fail(ErrorKind::config, "{}: {} = {}: the device has no such control; leave it out",
                  node_.path(), key, value);
    }
    const double steps = std::round((value / unit - range->low) / range->step);
    const double target = range->low + steps * range->step;
    const bool inside = target >= range->low && target <= range->high;
    if (inside) {
      const auto written = write(range->id, static_cast<int>(target));
      if (!written) return tl::make_unexpected(written.error());
    }
    const auto read_back = read(range->id);
    if (!read_back) return tl::make_unexpected(read_back.error());
    const std::optional<int>& now = *read_back;
    if (!now) return fail(ErrorKind::io, "{}: {} can't be read back", node_.path(), key);
    if (inside && std::abs(*now - target) <= range->step) {
      hold(range->id, *now);
      return *now * unit;
    }
    return fail(ErrorKind::config,
                "{}: {} = {} can't be set, the device has {}; it takes {} to {} in steps of {}",
                node_.path(), key, value, *now * unit, range->low * unit, range->high * unit,
                range->step * unit);
  }

  /// Switches an automatism off where the device has it: to the first of `manual` that it takes.
  /// False when it stays on.
  [[nodiscard]] Expected<bool> switch_off(std::uint32_t id, std::initializer_list<int> manual) {
    const auto found = find({id});
    if (!found) return tl::make_unexpected(found.error());
    if (!*found) return true;
    for (const int value : manual) {
      auto off = write(id, value);
      if (!off || *off) return off;
    }
    return false;
  }

  /// It is to stay at this value.
  void hold(std::uint32_t id, int value) {
    const auto known = std::find_if(held_.begin(), held_.end(),
                                    [&](const HeldControl& held) { return held.id == id; });
    if (known == held_.end()) {
      held_.push_back({id, value});
    } else {
      known->value = value;
    }
  }
  [[nodiscard]] const std::vector<HeldControl>& held() const { return held_; }

 private:
  [[nodiscard]] tl::unexpected<Error> cannot(std::string_view what, int failed) const {
    return tl::make_unexpected(node_error(node_, fmt::format("can't {}", what), failed));
  }

  VideoNode& node_;
  std::vector<HeldControl> held_;
};

/// Runs the steps until one fails.
class Applying {
 public:
  Applying(VideoNode& node, const CameraControls& wanted)
      : panel_(node), node_(node), wanted_(wanted) {}

  Expected<AppliedControls> run() {
    for (auto step : {&Applying::exposure, &Applying::gain, &Applying::white_balance,
                      &Applying::focus, &Applying::power_line}) {
      if (auto done = (this->*step)(); !done) return tl::make_unexpected(done.error());
    }
    applied_.held = panel_.held();
    return applied_;
  }

  Expected<AppliedControls> read() {
    if (auto done = read_exposure(); !done) return tl::make_unexpected(done.error());
    read_gain();
    return applied_;
  }

 private:
  Status exposure() {
    if (!wanted_.exposure_us) return read_exposure();
    const auto off = panel_.switch_off(V4L2_CID_EXPOSURE_AUTO,
                                       {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY});
    if (!off) return tl::make_unexpected(off.error());
    if (!*off) {
      note(kStaysAutomatic);
      return {};
    }
    // Longer exposures must not lower the frame rate.
    if (auto fixed = panel_.switch_off(V4L2_CID_EXPOSURE_AUTO_PRIORITY, {0}); !fixed) {
      return tl::make_unexpected(fixed.error());
    }
    const auto now = panel_.set("exposure_us", {V4L2_CID_EXPOSURE_ABSOLUTE}, *wanted_.exposure_us,
                                kExposureUnit_us);
    if (!now) return tl::make_unexpected(now.error());
    applied_.exposure = from_us(*now);
    return {};
  }

  Status read_exposure() {
    const auto mode = panel_.read(V4L2_CID_EXPOSURE_AUTO);
    if (!mode) return tl::make_unexpected(mode.error());
    if (is_automatic(*mode)) {
      note(wanted_.exposure_us ? kStaysAutomatic : kIsAutomatic);
      return {};
    }
    const auto range = panel_.find({V4L2_CID_EXPOSURE_ABSOLUTE});
    if (!range) return tl::make_unexpected(range.error());
    if (!*range) return {};
    const auto now = panel_.read(V4L2_CID_EXPOSURE_ABSOLUTE);
    if (!now) return tl::make_unexpected(now.error());
    if (!*now) return {};
    const double now_us = **now * kExposureUnit_us;
    const double step_us = (*range)->step * kExposureUnit_us;
    if (wanted_.exposure_us && std::abs(now_us - *wanted_.exposure_us) > step_us) {
      return fail(ErrorKind::io, "{}: exposure_us = {} was not set, the device has {}",
                  node_.path(), *wanted_.exposure_us, now_us);
    }
    applied_.exposure = from_us(now_us);
    if (*mode) panel_.hold(V4L2_CID_EXPOSURE_AUTO, **mode);
    panel_.hold(V4L2_CID_EXPOSURE_ABSOLUTE, **now);
    return {};
  }

  Status gain() {
    if (wanted_.gain) {
      if (auto off = automatic_off(V4L2_CID_AUTOGAIN, "automatic gain"); !off) return off;
      const auto now =
          panel_.set("gain", {V4L2_CID_GAIN, V4L2_CID_ANALOGUE_GAIN}, *wanted_.gain, 1);
      if (!now) return tl::make_unexpected(now.error());
      applied_.gain = *now;
      return {};
    }
    read_gain();
    return {};
  }

  /// Only told: a device whose gain nobody asked for is not refused because it can't say it.
  void read_gain() {
    const auto range = panel_.find({V4L2_CID_GAIN, V4L2_CID_ANALOGUE_GAIN});
    if (!range || !*range) return;
    if (const auto now = panel_.read((*range)->id); now && *now) applied_.gain = **now;
  }

  Status white_balance() {
    if (!wanted_.white_balance_k) return {};
    if (auto off = automatic_off(V4L2_CID_AUTO_WHITE_BALANCE, "automatic white balance"); !off) {
      return off;
    }
    return only_status(panel_.set("white_balance_k", {V4L2_CID_WHITE_BALANCE_TEMPERATURE},
                                  *wanted_.white_balance_k, 1));
  }

  Status focus() {
    if (auto off = automatic_off(V4L2_CID_FOCUS_AUTO, "automatic focus"); !off) return off;
    if (!wanted_.focus) return {};
    return only_status(panel_.set("focus", {V4L2_CID_FOCUS_ABSOLUTE}, *wanted_.focus, 1));
  }

  Status power_line() {
    if (!wanted_.power_line_hz) return {};
    const int hz = *wanted_.power_line_hz;
    const int choice = hz == 50   ? V4L2_CID_POWER_LINE_FREQUENCY_50HZ
                       : hz == 60 ? V4L2_CID_POWER_LINE_FREQUENCY_60HZ
                                  : V4L2_CID_POWER_LINE_FREQUENCY_DISABLED;
    const auto found = panel_.find({V4L2_CID_POWER_LINE_FREQUENCY});
    if (!found) return tl::make_unexpected(found.error());
    const auto set = *found ? panel_.write(V4L2_CID_POWER_LINE_FREQUENCY, choice) : false;
    if (!set) return tl::make_unexpected(set.error());
    if (*set) return {};
    return fail(ErrorKind::config, "{}: power_line_hz = {} can't be set; leave it out",
                node_.path(), hz);
  }

  Status automatic_off(std::uint32_t id, std::string_view what) {
    const auto off = panel_.switch_off(id, {0});
    if (!off) return tl::make_unexpected(off.error());
    if (!*off) note(fmt::format("{} can't be switched off", what));
    return {};
  }

  [[nodiscard]] static bool is_automatic(const std::optional<int>& mode) {
    return mode && *mode != V4L2_EXPOSURE_MANUAL && *mode != V4L2_EXPOSURE_SHUTTER_PRIORITY;
  }

  static Status only_status(const Expected<double>& set) {
    if (!set) return tl::make_unexpected(set.error());
    return {};
  }
  void note(std::string_view text) {
    applied_.notes.push_back(fmt::format("{}: {}", node_.path(), text));
  }

  ControlPanel panel_;
  VideoNode& node_;
  const CameraControls& wanted_;
  AppliedControls applied_;
};

}  // namespace

Expected<AppliedControls> apply_controls(VideoNode& node, const CameraControls& controls) {
  return Applying(node, controls).run();
}

Expected<AppliedControls> read_controls(VideoNode& node, const CameraControls& wanted) {
  return Applying(node, wanted).read();
}

}  // namespace waymark
