#pragma once

#include <array>
#include <cstdint>

#include "core/capture/gray_image.h"

namespace waymark {

/// What counts as contrast in an image: a quarter of its places of 12×12 pixels show nothing but
/// noise, as a rule; their contrast times 1.6 is hardly ever reached by noise alone. Where an image
/// is darker it may have less.
class ContrastGates {
 public:
  ContrastGates() = default;

  /// A place's darkest and brightest pixel.
  void add(std::uint8_t darkest, std::uint8_t brightest);
  /// What has been added since the last call decides from now on.
  void settle();

  /// Least contrast (grey levels) that is more than noise, where it is greatest.
  [[nodiscard]] int gate_grey() const { return gate_grey_; }
  /// The same where the brightest pixel is that bright.
  [[nodiscard]] int at(std::uint8_t brightest) const { return gates_[brightest]; }

 private:
  static constexpr std::size_t kLevels = 16;

  /// Contrasts that were counted.
  struct Contrasts {
    std::array<int, 256> counts{};
    int all = 0;
    void add(int contrast);
    /// The contrast that this share of the places does not reach.
    [[nodiscard]] int quantile(double share) const;
  };

  Contrasts everywhere_;
  std::array<Contrasts, kLevels> by_level_{};  ///< by the brightest: shot noise grows with light
  int gate_grey_ = 0;
  std::array<std::uint8_t, 256> gates_{};
};

}  // namespace waymark
