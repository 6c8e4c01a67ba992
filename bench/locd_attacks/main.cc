// What locd makes of rigs, maps and buildings that are not what it was told: see
// bench/locd_attacks/attack.h. Prints one row per attack and rig, rooms and aisles by turns.
#include <CLI/CLI.hpp>

#include "bench/locd_attacks/run_attack.h"

int main(int argc, char** argv) {
  using namespace waymark::bench;
  std::string only;
  std::vector<std::string> rigs = {"mono", "cg60", "cg120"};
  int seeds = 4;
  int sets = 1500;
  bool verbose = false;
  CLI::App app("Attacks on locd, judged by the truth");
  app.add_option("--only", only, "Attacks whose names contain this");
  app.add_option("--rigs", rigs, "mono, cg60, cg120")->delimiter(',');
  app.add_option("--seeds", seeds, "Runs per row, rooms and aisles by turns");
  app.add_option("--sets", sets, "Frame sets per run");
  app.add_flag("--verbose", verbose, "Every alert of every run");
  CLI11_PARSE(app, argc, argv);
  for (const Attack& attack : all_attacks()) {
    if (attack.name.find(only) == std::string::npos) continue;
    for (const std::string& rig : rigs) {
      if (attack.needs_cameras && rig == "mono") continue;
      AttackFigures figures;
      for (int seed = 1; seed <= seeds; ++seed) {
        const auto one = run_attack(attack, {seed % 2 == 1 ? "room1" : "warehouse", rig,
                                             static_cast<std::uint64_t>(seed), sets});
        figures.add(one);
        if (verbose) {
          fmt::print("  seed {}: {}\n    {}\n    {}\n", seed, row_of(one), reasons_of(one),
                     one.alerts);
        }
      }
      fmt::print("{:<28} {:<6} {}\n", attack.name, rig, row_of(figures));
      std::fflush(stdout);
    }
  }
}
