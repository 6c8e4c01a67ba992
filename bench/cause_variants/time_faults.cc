#include <algorithm>
#include <cmath>

#include "bench/cause_variants/faults.h"

namespace waymark::bench {
namespace {

using simulator::Random;

std::size_t some_camera(const World& world, Random& random) {
  return static_cast<std::size_t>(random.below(world.cameras()));
}

/// Of two, the one that the other is held against takes the opposite sign.
double against_the_others(const World& world, std::size_t camera, double value) {
  return world.cameras() == 2 && camera == 0 ? -value : value;
}

Stamp milliseconds(double ms) { return Stamp(std::llround(ms * 1e6)); }

/// Exposed earlier or later than stamped, by the same all the time.
bool late(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = some_camera(world, random);
  const double older_ms = either_sign(5, 100, random);
  for (auto& set : world.exposed_s) set[camera] -= older_ms * 1e-3;
  variant.truth.causes = {Cause::clock};
  variant.truth.cameras = one_or_either(world, camera);
  variant.truth.value = against_the_others(world, camera, older_ms);
  variant.truth.within = 0.5 + 0.01 * std::abs(older_ms);
  variant.truth.exits = {65};
  return true;
}

/// Shutters run free; sets are made of what is nearest.
bool free_running(Variant& variant, Random& random) {
  World& world = variant.world();
  for (auto& set : world.exposed_s) {
    for (std::size_t k = 1; k < set.size(); ++k) {
      set[k] += random.uniform(-0.5, 0.5) * std::min(0.1, world.period_s);
    }
  }
  variant.truth.causes = {Cause::clock};
  variant.truth.cameras = every_camera(world);
  variant.truth.exits = {65};
  return true;
}

/// Taken together, stamped by clocks that are some milliseconds apart.
bool stamped_apart(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = some_camera(world, random);
  const double ahead_ms = either_sign(7, 350 * world.period_s, random);
  for (auto& set : world.stamps) set[camera] += milliseconds(ahead_ms);
  variant.truth.causes = {Cause::clock};
  variant.truth.cameras = one_or_either(world, camera);
  variant.truth.value = against_the_others(world, camera, ahead_ms);
  variant.truth.within = 0.5;
  return true;
}

bool another_epoch(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = some_camera(world, random);
  const Stamp since_boot = Stamp(std::llround(random.uniform(1e2, 1e6) * 1e9));
  const Stamp start = world.stamps.front()[camera];
  for (auto& set : world.stamps) set[camera] += since_boot - start;
  variant.truth.causes = {Cause::clock};
  variant.truth.cameras = one_or_either(world, camera);
  return true;
}

bool drifting(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = some_camera(world, random);
  const double span_s = world.period_s * static_cast<double>(world.sets - 1);
  const double grown_ms = either_sign(15, 60, random);
  for (std::size_t set = 0; set < world.sets; ++set) {
    world.stamps[set][camera] +=
        milliseconds(grown_ms * static_cast<double>(set) / static_cast<double>(world.sets - 1));
  }
  variant.truth.causes = {Cause::clock};
  variant.truth.cameras = one_or_either(world, camera);
  variant.truth.value = against_the_others(world, camera, grown_ms * 60 / span_s);
  variant.truth.within = 0.03 * std::abs(*variant.truth.value);
  return true;
}

/// Images were paired by number after one or two were lost.
bool lost_frame(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = some_camera(world, random);
  const std::size_t lost = 1 + random.below(2);
  const std::size_t from = world.sets / 4 + random.below(world.sets / 2);
  for (std::size_t set = from; set < world.sets; ++set) {
    // The exposure of the set so many later; beyond the last, as regular as all.
    const std::size_t shown = std::min(set + lost, world.sets - 1);
    world.exposed_s[set][camera] =
        world.exposed_s[shown][camera] + static_cast<double>(set + lost - shown) * world.period_s;
  }
  variant.truth.causes = {Cause::frame_order};
  variant.truth.cameras = one_or_either(world, camera);
  variant.truth.value = against_the_others(world, camera, static_cast<double>(lost));
  variant.truth.within = 0.1;
  variant.truth.exits = {65};
  return true;
}

constexpr Fault kFaults[] = {
    {Cause::clock, "one camera exposes early or late", 2, true, late},
    {Cause::clock, "shutters run free", 2, true, free_running},
    {Cause::clock, "stamps milliseconds apart", 2, true, stamped_apart},
    {Cause::clock, "stamps of another epoch", 2, false, another_epoch},
    {Cause::clock, "one clock drifts", 2, true, drifting},
    {Cause::frame_order, "paired by number, frames lost", 2, true, lost_frame},
};

}  // namespace

std::span<const Fault> time_faults() { return kFaults; }

}  // namespace waymark::bench
