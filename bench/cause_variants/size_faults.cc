#include <cmath>

#include "bench/cause_variants/faults.h"

namespace waymark::bench {
namespace {

using simulator::Random;

void multiply_stated_sizes(World& world, double by) {
  auto entries = world.stated_catalog.entries();
  for (auto& entry : entries) {
    if (entry.default_size_m) *entry.default_size_m *= by;
    for (auto& [id, size_m] : entry.size_m_by_id) size_m *= by;
  }
  world.stated_catalog = MarkerCatalog(std::move(entries));
}

bool all_sizes(Variant& variant, Random& random) {
  World& world = variant.world();
  const double off = either_sign(0.03, 0.2, random);
  multiply_stated_sizes(world, 1 + off);
  variant.truth.causes = {Cause::size_scale};
  variant.truth.cameras = every_camera(world);
  variant.truth.value = 100 * off;
  variant.truth.within = 0.5;
  return true;
}

bool baselines(Variant& variant, Random& random) {
  World& world = variant.world();
  const double off = either_sign(0.05, 0.2, random);
  for (RigCamera& camera : world.stated_rig.cameras) camera.rig_from_cam.translation *= 1 + off;
  variant.truth.causes = {Cause::size_scale};
  variant.truth.cameras = every_camera(world);
  variant.truth.value = 100 * (1 / (1 + off) - 1);
  variant.truth.within = 0.5;
  return true;
}

bool sizes_against_survey(Variant& variant, Random& random) {
  const auto measured = measure(variant.world(), random);
  if (!measured) return false;
  Measured some = *measured;
  if (random.uniform() < 0.5) some.points.clear();
  variant.survey_toml = survey_toml(variant.world(), some);
  return all_sizes(variant, random);
}

/// The print of some markers is larger or smaller than stated.
bool some_sizes(Variant& variant, Random& random, std::size_t count) {
  World& world = variant.world();
  constexpr int kSights = 10;
  const auto markers = often_seen(world, kSights, count, random);
  if (markers.size() < count) return false;
  const double factor = 1 + either_sign(0.03, 0.2, random);
  for (const std::size_t marker : markers) {
    world.scene.markers[marker].size_m *= factor;
    variant.truth.markers.insert(world.scene.markers[marker].id);
  }
  variant.truth.causes = {Cause::size};
  if (count == 1) variant.truth.value = world.scene.markers[markers.front()].size_m;
  variant.truth.within = 0.002;
  return true;
}

bool one_size(Variant& variant, Random& random) { return some_sizes(variant, random, 1); }
bool a_group(Variant& variant, Random& random) { return some_sizes(variant, random, 4); }

bool all_not_square(Variant& variant, Random& random) {
  World& world = variant.world();
  const double wider = 1 + either_sign(0.015, 0.05, random);
  for (std::size_t i = 0; i < world.scene.markers.size(); ++i) world.wider[i] = wider;
  variant.truth.causes = {Cause::print_not_square};
  variant.truth.value = 100 * (wider - 1);
  variant.truth.within = 0.3;
  return true;
}

bool two_not_square(Variant& variant, Random& random) {
  World& world = variant.world();
  constexpr int kSights = 10;
  const auto markers = often_seen(world, kSights, 2, random);
  if (markers.size() < 2) return false;
  const double wider = 1 + either_sign(0.04, 0.08, random);
  for (const std::size_t marker : markers) {
    world.wider[marker] = wider;
    variant.truth.markers.insert(world.scene.markers[marker].id);
  }
  variant.truth.causes = {Cause::print_not_square};
  variant.truth.value = 100 * (wider - 1);
  variant.truth.within = 0.5;
  return true;
}

constexpr Fault kFaults[] = {
    {Cause::size_scale, "all sizes 3 to 20 % off", 2, false, all_sizes},
    {Cause::size_scale, "baselines 5 to 20 % off", 2, false, baselines},
    {Cause::size_scale, "sizes off against a survey", 1, false, sizes_against_survey},
    {Cause::size, "one marker's size 3 to 20 % off", 1, false, one_size},
    {Cause::size, "four markers' sizes off", 1, false, a_group},
    {Cause::print_not_square, "all markers 1.5 to 5 % not square", 1, false, all_not_square},
    {Cause::print_not_square, "two markers bent", 1, false, two_not_square},
};

}  // namespace

std::span<const Fault> size_faults() { return kFaults; }

}  // namespace waymark::bench
