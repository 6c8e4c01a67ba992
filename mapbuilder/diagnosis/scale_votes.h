#pragma once

#include <string>
#include <vector>

namespace waymark {

enum class ScaleSide { sizes, baselines, points, distance };

/// One who states the scale: its lengths over those of the stated sizes.
struct ScaleWitness {
  ScaleSide side = ScaleSide::sizes;
  double log_scale = 0;   ///< natural logarithm
  double sigma = 0;       ///< of it; positive
  double weight = 1;      ///< votes
  std::size_t entry = 0;  ///< of a distance: which
};

/// Those who agree with one of them within five sigmas of both.
struct ScaleParty {
  std::vector<ScaleWitness> members;
  double weight = 0;     ///< all their votes
  double log_scale = 0;  ///< mean of the members, by their sigmas
  double sigma = 0;
};

/// The party with most votes; of equals that of the surest witness. Empty of nobody.
[[nodiscard]] ScaleParty heaviest_of(std::vector<ScaleWitness> all);

[[nodiscard]] bool holds(const ScaleParty& party, const ScaleWitness& one);

/// "the stated sizes, 2 distances"
[[nodiscard]] std::string names_of(const std::vector<ScaleWitness>& witnesses);

}  // namespace waymark
