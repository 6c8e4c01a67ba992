#pragma once

namespace waymark::bench {

/// (a) and (c): how near to the Cramér–Rao bound, how true the covariance, how many sets are OK.
void measure_bound(int sets);
/// (d): everything goes wrong at once; no OK pose may be wrong.
void measure_faults(int sets);
/// (e): moved markers lose their pull, and are named.
void measure_moved(int sets);
/// (f): cameras that expose one after the other, on the move.
void measure_skew(int sets);
/// (g): a camera that does not stand where the rig file says, two in each other's place.
void measure_cameras(int sets);

}  // namespace waymark::bench
