#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/locd_attacks/attack.h"

namespace waymark::bench {

/// What one run, or several, showed. Sets count from the beginning of what is wrong.
struct AttackFigures {
  int runs = 0;
  int sets = 0;
  int ok = 0;
  int firm = 0;        ///< sets with a pose whose own 3 sigma are within the limits
  int firm_ok = 0;     ///< of them OK
  int wrong = 0;       ///< OK, off by more than 20 mm or 0.5°, and by more than 5 sigmas of it
  int beyond3 = 0;     ///< OK and off by more than 3 sigmas
  double nees = 0;     ///< summed over OK poses
  double worst_m = 0;  ///< of the wrong ones
  int after = 0;       ///< sets from 100 after the end on
  int after_ok = 0;
  int innocent_markers = 0;  ///< alerts that name one that nothing is wrong with
  int innocent_cameras = 0;
  int other_causes = 0;          ///< the right camera or marker for another reason
  std::vector<int> named_after;  ///< sets until the first right alert, one per run that has one
  int over = 0;                  ///< runs in which it was said to be over
  std::string alerts;            ///< what was said, run by run
  std::map<std::string, int> reasons;  ///< sets that were not OK, by each reason

  void add(const AttackFigures& other);
};

/// Who drives where: a scene and a rig ("mono": its first camera alone), and everything that is
/// drawn.
struct AttackRun {
  std::string scene;
  std::string rig;
  std::uint64_t seed = 1;
  int sets = 1500;
};

/// Drives once through what the attack makes of the scene.
[[nodiscard]] AttackFigures run_attack(const Attack& attack, const AttackRun& run);

/// One line of the table.
[[nodiscard]] std::string row_of(const AttackFigures& figures);
/// Why sets were not OK.
[[nodiscard]] std::string reasons_of(const AttackFigures& figures);

}  // namespace waymark::bench
