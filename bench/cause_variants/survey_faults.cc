#include <cmath>

#include "bench/cause_variants/faults.h"
#include "core/marker/marker_geometry.h"

namespace waymark::bench {
namespace {

using simulator::Random;

MarkerId id_of(const World& world, std::size_t marker) { return world.scene.markers[marker].id; }

bool unit(Variant& variant, Random& random) {
  constexpr double kPerMetre[] = {1000, 100, 1 / 0.0254, 1 / 0.3048};
  auto measured = measure(variant.world(), random);
  if (!measured) return false;
  const double factor = kPerMetre[random.below(4)];
  for (auto& point : measured->points) point.position_m *= factor;
  for (auto& distance : measured->distances) distance.distance_m *= factor;
  if (random.uniform() < 0.5) measured->points.clear();
  variant.survey_toml = survey_toml(variant.world(), *measured);
  variant.truth.causes = {Cause::survey_unit};
  variant.truth.value = factor;
  variant.truth.within = 0.01 * factor;
  variant.truth.exits = {65};
  return true;
}

bool mirrored(Variant& variant, Random& random) {
  auto measured = measure(variant.world(), random);
  if (!measured) return false;
  const auto axis = static_cast<Eigen::Index>(random.below(2));
  for (auto& point : measured->points) point.position_m[axis] = 20 - point.position_m[axis];
  variant.survey_toml = survey_toml(variant.world(), *measured);
  variant.truth.causes = {Cause::survey_mirrored};
  variant.truth.exits = {65};
  return true;
}

bool one_point(Variant& variant, Random& random) {
  auto measured = measure(variant.world(), random);
  if (!measured) return false;
  auto& wrong = measured->points[random.below(measured->points.size())];
  const double off_m = either_sign(0.05, 1, random);
  wrong.position_m[static_cast<Eigen::Index>(random.below(3))] += off_m;
  variant.survey_toml = survey_toml(variant.world(), *measured);
  variant.truth.causes = {Cause::survey_entry};
  variant.truth.markers = {id_of(variant.world(), wrong.marker)};
  variant.truth.value = std::abs(off_m);
  variant.truth.within = 0.02;
  variant.truth.exits = {0};
  return true;
}

bool points_exchanged(Variant& variant, Random& random) {
  auto measured = measure(variant.world(), random);
  if (!measured) return false;
  auto& a = measured->points[0];
  auto& b = measured->points[1 + random.below(measured->points.size() - 1)];
  std::swap(a.position_m, b.position_m);
  variant.survey_toml = survey_toml(variant.world(), *measured);
  variant.truth.causes = {Cause::survey_entry};
  variant.truth.markers = {id_of(variant.world(), a.marker), id_of(variant.world(), b.marker)};
  variant.truth.exits = {0};
  return true;
}

bool one_distance(Variant& variant, Random& random) {
  auto measured = measure(variant.world(), random);
  if (!measured) return false;
  auto& wrong = measured->distances[random.below(measured->distances.size())];
  const double factor = 1 + either_sign(0.05, 0.3, random);
  wrong.distance_m *= factor;
  variant.survey_toml = survey_toml(variant.world(), *measured);
  variant.truth.causes = {Cause::survey_entry};
  variant.truth.markers = {id_of(variant.world(), wrong.from), id_of(variant.world(), wrong.to)};
  variant.truth.value = factor;
  variant.truth.within = 0.01;
  variant.truth.exits = {0};
  return true;
}

bool corner(Variant& variant, Random& random) {
  const World& world = variant.world();
  auto measured = measure(world, random);
  if (!measured) return false;
  const std::size_t at = random.below(4);
  for (auto& point : measured->points) {
    const auto& marker = world.scene.markers[point.marker];
    point.position_m += marker.world_from_marker.rotation * marker_corners(marker.size_m)[at];
  }
  measured->distances.clear();
  variant.survey_toml = survey_toml(world, *measured);
  variant.truth.causes = {Cause::survey_corner};
  variant.truth.exits = {65};
  return true;
}

constexpr Fault kFaults[] = {
    {Cause::survey_unit, "survey in mm, cm, inches, feet", 1, false, unit},
    {Cause::survey_mirrored, "one axis of the survey reversed", 1, false, mirrored},
    {Cause::survey_entry, "one point mistyped", 1, false, one_point},
    {Cause::survey_entry, "two points exchanged", 1, false, points_exchanged},
    {Cause::survey_entry, "one distance mistyped", 1, false, one_distance},
    {Cause::survey_corner, "measured at another corner", 1, false, corner},
};

}  // namespace

std::span<const Fault> survey_faults() { return kFaults; }

}  // namespace waymark::bench
