#include "core/camera/camera_sigmas.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

namespace waymark {
namespace {

constexpr std::array kSources{std::pair{SigmaSource::kalibr, std::string_view("kalibr")},
                              std::pair{SigmaSource::opencv, std::string_view("opencv")},
                              std::pair{SigmaSource::hand, std::string_view("hand")},
                              std::pair{SigmaSource::refined, std::string_view("refined")}};

constexpr double kRadPerDeg = std::numbers::pi / 180;

/// What does not depend on the images. OpenCV calibrates a camera alone: where several stand in
/// one file, somebody has measured their places.
CameraSigmas calibrated_sigmas(SigmaSource source) {
  switch (source) {
    case SigmaSource::opencv:
      return {0.005, 0.5 * kRadPerDeg, 0.003, 1.5, 0.01};
    case SigmaSource::hand:
      return {0.005, 0.5 * kRadPerDeg, 0.01, 5, 0.05};
    case SigmaSource::kalibr:
    case SigmaSource::refined:
      break;
  }
  return {0.001, 0.05 * kRadPerDeg, 0.001, 0.5, 0.005};
}

/// Of a stated read-out time so much; of one that nobody has stated so many seconds.
constexpr double kReadoutShare = 0.02;
constexpr double kUnknownReadout_s = 0.005;

}  // namespace

std::string_view to_string(SigmaSource source) {
  return kSources.at(static_cast<std::size_t>(source)).second;
}

std::optional<SigmaSource> sigma_source_from(std::string_view name) {
  const auto* const found = std::find_if(kSources.begin(), kSources.end(),
                                         [&](const auto& known) { return known.second == name; });
  if (found == kSources.end()) return std::nullopt;
  return found->first;
}

CameraSigmas default_sigmas(SigmaSource source, std::optional<double> readout_s,
                            const SigmaCircumstances& circumstances) {
  CameraSigmas sigmas = calibrated_sigmas(source);
  sigmas.edge_px = 0.2;
  sigmas.stamp_s = circumstances.triggered ? 2e-5 : 1e-3;
  sigmas.readout_s = readout_s ? kReadoutShare * *readout_s : kUnknownReadout_s;
  return sigmas;
}

}  // namespace waymark
