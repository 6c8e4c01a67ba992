#pragma once

#include "simulator/random.h"
#include "simulator/scene.h"

namespace waymark::bench {

/// Hangs one of the building's markers elsewhere: by a distance in any direction but into its wall,
/// turned about any axis.
void move_marker(simulator::Scene& building, std::size_t marker, double distance_m, double turn_rad,
                 simulator::Random& random);

}  // namespace waymark::bench
