#pragma once

#include <cmath>

namespace waymark {

/// Robust losses ρ(s) of a squared residual s in sigmas², ρ(s) ≈ s for small s, and their weights
/// ρ'(s).
enum class Loss { squared, huber, tukey };

/// `scale_sigmas` > 0: Huber turns linear there; Tukey's biweight is flat from there on.
[[nodiscard]] inline double robust_cost(Loss loss, double scale_sigmas, double s) {
  const double k2 = scale_sigmas * scale_sigmas;
  switch (loss) {
    case Loss::huber:
      return s <= k2 ? s : 2.0 * scale_sigmas * std::sqrt(s) - k2;
    case Loss::tukey: {
      if (s >= k2) return k2 / 3.0;
      const double u = 1.0 - s / k2;
      return k2 / 3.0 * (1.0 - u * u * u);
    }
    case Loss::squared:
      break;
  }
  return s;
}

/// ρ'(s), in [0, 1].
[[nodiscard]] inline double robust_weight(Loss loss, double scale_sigmas, double s) {
  const double k2 = scale_sigmas * scale_sigmas;
  switch (loss) {
    case Loss::huber:
      return s <= k2 ? 1.0 : scale_sigmas / std::sqrt(s);
    case Loss::tukey: {
      if (s >= k2) return 0.0;
      const double u = 1.0 - s / k2;
      return u * u;
    }
    case Loss::squared:
      break;
  }
  return 1.0;
}

}  // namespace waymark
