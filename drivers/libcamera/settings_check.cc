#include "drivers/libcamera/settings_check.h"

#include <libcamera/control_ids.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace waymark {
namespace {

namespace controls = libcamera::controls;

/// Sensors count exposures in rows, which take 5 to 100 µs (20–500 µs) …
constexpr double kRow_us = 100;
/// … and long ones in several rows at once (0.5–5 %).
constexpr double kSameExposure = 0.02;
/// Sensors' gains have steps of up to 1/16 (7–15 %).
constexpr double kSameGain = 0.1;

/// One setting, as asked for and as a frame was taken with.
struct Setting {
  std::string_view key;  ///< in locd.toml
  std::optional<double> wanted;
  std::optional<double> told;
  double slack = 0;  ///< in the same unit

  /// What nobody asked for or the camera does not tell differs from nothing.
  [[nodiscard]] bool differs() const { return wanted && told && std::abs(*told - *wanted) > slack; }
};

template <typename T>
std::optional<double> told(const libcamera::ControlList& metadata,
                           const libcamera::Control<T>& control) {
  const auto value = metadata.get(control);
  return value ? std::optional(static_cast<double>(*value)) : std::nullopt;
}

std::optional<double> told_rate(const libcamera::ControlList& metadata) {
  const auto period_us = told(metadata, controls::FrameDuration);
  return period_us && *period_us > 0 ? std::optional(1e6 / *period_us) : std::nullopt;
}

std::array<Setting, 3> settings_of(const libcamera::ControlList& metadata,
                                   const CameraOptions& wanted) {
  const auto [exposure_us, gain] = std::pair(wanted.controls.exposure_us, wanted.controls.gain);
  const double fps = wanted.request.fps;
  return {
      {{"exposure_us", exposure_us, told(metadata, controls::ExposureTime),
        std::max(kRow_us, kSameExposure * exposure_us.value_or(0))},
       {"gain", gain, told(metadata, controls::AnalogueGain), kSameGain * gain.value_or(0)},
       {"fps", fps > 0 ? std::optional(fps) : std::nullopt, told_rate(metadata), kSameRate * fps}}};
}

}  // namespace

Expected<bool> SettingsCheck::look(const libcamera::ControlList& metadata,
                                   const CameraOptions& wanted) {
  const auto settings = settings_of(metadata, wanted);
  const auto* const wrong = std::find_if(settings.begin(), settings.end(),
                                         [](const Setting& setting) { return setting.differs(); });
  if (wrong == settings.end()) return true;
  if (++unlike_ < kLatest) return false;
  return fail(ErrorKind::config,
              "{}: {} = {} can't be set, its frames have {:.6g}; set that, or what limits it",
              wanted.name, wrong->key, *wrong->wanted, *wrong->told);
}

}  // namespace waymark
