#include "core/detect/contrast_gates.h"

#include <algorithm>

namespace waymark {

void ContrastGates::Contrasts::add(int contrast) {
  ++counts[static_cast<std::size_t>(contrast)];
  ++all;
}

int ContrastGates::Contrasts::quantile(double share) const {
  int contrast = 0;
  int seen = counts[0];
  while (contrast < 255 && seen <= share * all) {
    seen += counts[static_cast<std::size_t>(++contrast)];
  }
  return contrast;
}

void ContrastGates::add(std::uint8_t darkest, std::uint8_t brightest) {
  everywhere_.add(brightest - darkest);
  by_level_[brightest / (256 / kLevels)].add(brightest - darkest);
}

void ContrastGates::settle() {
  constexpr double kShareWithoutEdges = 0.25;
  constexpr double kAboveNoise = 1.6;
  constexpr int kEnough = 50;  // places: with fewer, a few edges decide
  // Below, paper's own texture and the codec's blocks are found; above, a marker in half shadow is
  // lost.
  constexpr int kLeastGate = 20;
  constexpr int kMostGate = 70;
  const auto gate = [&](int grey) {
    return std::clamp(static_cast<int>(kAboveNoise * grey), kLeastGate, kMostGate);
  };
  const int noise = everywhere_.quantile(kShareWithoutEdges);
  gate_grey_ = gate(noise);
  for (std::size_t brightest = 0; brightest < gates_.size(); ++brightest) {
    const Contrasts& level = by_level_[brightest / (gates_.size() / kLevels)];
    const int here = level.all < kEnough ? noise : level.quantile(kShareWithoutEdges);
    gates_[brightest] = static_cast<std::uint8_t>(gate(std::min(noise, here)));
  }
  everywhere_ = {};
  by_level_ = {};
}

}  // namespace waymark
