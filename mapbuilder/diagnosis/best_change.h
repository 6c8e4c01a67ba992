#pragma once

#include <numeric>
#include <vector>

namespace waymark {

/// Where to change from one row of costs to another, and what that costs in all.
struct Change {
  std::size_t at = 0;  ///< first of the second row
  double cost = 0;

  /// Whether each side of the change has at least `fewest` of `count`.
  [[nodiscard]] bool splits(std::size_t count, std::size_t fewest) const {
    return at >= fewest && count - at >= fewest;
  }
};

/// The cheapest change; rows of one length.
inline Change best_change(const std::vector<double>& before, const std::vector<double>& after) {
  double cost = std::accumulate(after.begin(), after.end(), 0.0);
  Change best{0, cost};
  for (std::size_t j = 0; j < before.size(); ++j) {
    cost += before[j] - after[j];
    if (cost < best.cost) best = {j + 1, cost};
  }
  return best;
}

}  // namespace waymark
