// Accuracy and integrity of locd on simulated detections. Usage: bench_locd_accuracy
// [bound|faults|moved|skew|cameras] [SETS]; without an argument all of them. Alignment: none, poses
// are in the true map's frame.
#include <cstdlib>
#include <string>

#include "bench/locd_accuracy/measurements.h"

int main(int argc, char** argv) {
  using namespace waymark::bench;
  const std::string what = argc > 1 ? argv[1] : "all";
  const int sets = argc > 2 ? std::atoi(argv[2]) : 0;
  const auto wanted = [&](const char* name) { return what == name || what == "all"; };
  const auto count = [&](int usual) { return sets > 0 ? sets : usual; };
  if (wanted("bound")) measure_bound(count(2000));
  if (wanted("faults")) measure_faults(count(100'000));
  if (wanted("moved")) measure_moved(count(3000));
  if (wanted("skew")) measure_skew(count(3000));
  if (wanted("cameras")) measure_cameras(count(10'000));
}
