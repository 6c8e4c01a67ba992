#include <cmath>
#include <numbers>

#include "bench/cause_variants/faults.h"
#include "core/geometry/so3.h"

namespace waymark::bench {
namespace {

using simulator::Random;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

Eigen::Vector3d some_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

/// T_cn_cnm1 of the links from `first` on to `last` the other way round.
void invert_links(Rig& rig, std::size_t first, std::size_t last) {
  std::vector<Rigid3> links;
  for (std::size_t n = 1; n < rig.cameras.size(); ++n) {
    links.push_back(rig.cameras[n].rig_from_cam.inverse() * rig.cameras[n - 1].rig_from_cam);
  }
  for (std::size_t n = first; n <= last; ++n) links[n - 1] = links[n - 1].inverse();
  for (std::size_t n = 1; n < rig.cameras.size(); ++n) {
    rig.cameras[n].rig_from_cam = rig.cameras[n - 1].rig_from_cam * links[n - 1].inverse();
  }
}

/// Of two cameras that change places and a link the other way round nobody can tell the one from
/// the other.
std::set<Cause> inverted_or_exchanged(const World& world, Cause cause) {
  if (world.cameras() == 2) return {Cause::rig_inverted, Cause::rig_exchanged};
  return {cause};
}

bool chain_inverted(Variant& variant, Random&) {
  World& world = variant.world();
  invert_links(world.stated_rig, 1, world.cameras() - 1);
  variant.truth.causes = inverted_or_exchanged(world, Cause::rig_inverted);
  variant.truth.cameras = every_camera(world);
  variant.truth.exits = {65};
  return true;
}

bool link_inverted(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t link = 1 + random.below(world.cameras() - 1);
  invert_links(world.stated_rig, link, link);
  variant.truth.causes = {Cause::rig_inverted};
  variant.truth.cameras = {world.rig.cameras[link].name};
  variant.truth.exits = {65};
  return true;
}

bool unit(Variant& variant, Random& random) {
  constexpr double kPerMetre[] = {1000, 100, 1 / 0.0254, 1 / 0.3048};
  World& world = variant.world();
  const double factor = kPerMetre[random.below(4)];
  for (RigCamera& camera : world.stated_rig.cameras) camera.rig_from_cam.translation *= factor;
  variant.truth.causes = {Cause::rig_unit};
  variant.truth.cameras = every_camera(world);
  variant.truth.exits = {65};
  return true;
}

bool turned(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = random.below(world.cameras());
  const double angle_deg = 90.0 * static_cast<double>(1 + random.below(3));
  Rigid3& stated = world.stated_rig.cameras[camera].rig_from_cam;
  stated.rotation = stated.rotation * so3_exp({0, 0, angle_deg * kRadPerDeg});
  variant.truth.causes = {Cause::rig_turned};
  if (angle_deg == 180) variant.truth.causes.insert(Cause::images_turned);
  variant.truth.cameras = one_or_either(world, camera);
  variant.truth.exits = {65};
  return true;
}

std::pair<std::size_t, std::size_t> two_cameras(const World& world, Random& random) {
  const std::size_t a = random.below(world.cameras());
  const std::size_t b = (a + 1 + random.below(world.cameras() - 1)) % world.cameras();
  return {a, b};
}

void blame_exchange(Variant& variant, std::size_t a, std::size_t b) {
  const World& world = variant.world();
  variant.truth.causes = inverted_or_exchanged(world, Cause::rig_exchanged);
  variant.truth.cameras = {world.rig.cameras[a].name, world.rig.cameras[b].name};
  variant.truth.exits = {65};
}

/// Plugs or folders: each camera's images carry the other's name.
bool images_exchanged(Variant& variant, Random& random) {
  const auto [a, b] = two_cameras(variant.world(), random);
  variant.on_images.emplace_back(
      [a = static_cast<int>(a), b = static_cast<int>(b)](std::vector<ImageDetections>& images) {
        for (ImageDetections& image : images) {
          image.camera = image.camera == a ? b : image.camera == b ? a : image.camera;
        }
      });
  blame_exchange(variant, a, b);
  return true;
}

/// Only the places in rig.yaml; each keeps its own lens.
bool places_exchanged(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto [a, b] = two_cameras(world, random);
  std::swap(world.stated_rig.cameras[a].rig_from_cam, world.stated_rig.cameras[b].rig_from_cam);
  blame_exchange(variant, a, b);
  return true;
}

bool displaced(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = random.below(world.cameras());
  const double moved_m = random.uniform(0.01, 0.06);
  const double turned_deg = random.uniform(1, 8);
  Rigid3& stated = world.stated_rig.cameras[camera].rig_from_cam;
  stated = stated * Rigid3{so3_exp(turned_deg * kRadPerDeg * some_direction(random)),
                           moved_m * some_direction(random)};
  variant.truth.causes = {Cause::rig_displaced};
  variant.truth.cameras = one_or_either(world, camera);
  if (world.cameras() > 2) variant.truth.value = moved_m;
  variant.truth.within = 0.001;
  return true;
}

bool bumped(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t camera = random.below(world.cameras());
  const double turned_deg = random.uniform(1, 6);
  const Rigid3& before = world.rig.cameras[camera].rig_from_cam;
  const Rigid3 after = before * Rigid3{so3_exp(turned_deg * kRadPerDeg * some_direction(random)),
                                       random.uniform(0, 0.03) * some_direction(random)};
  world.bumps.push_back({camera, world.sets / 3 + random.below(world.sets / 3), after});
  variant.truth.causes = {Cause::rig_bumped};
  variant.truth.cameras = one_or_either(world, camera);
  variant.truth.value = turned_deg;
  variant.truth.within = 0.1;
  variant.truth.exits = {65};
  return true;
}

constexpr Fault kFaults[] = {
    {Cause::rig_inverted, "chain inverted", 2, false, chain_inverted},
    {Cause::rig_inverted, "one link inverted", 3, false, link_inverted},
    {Cause::rig_unit, "baselines in mm, cm, inches, feet", 2, false, unit},
    {Cause::rig_turned, "a camera turned by 90, 180, 270 degrees", 2, false, turned},
    {Cause::rig_exchanged, "images of two cameras exchanged", 2, false, images_exchanged},
    {Cause::rig_exchanged, "places of two cameras exchanged", 2, false, places_exchanged},
    {Cause::rig_displaced, "a camera displaced", 2, false, displaced},
    {Cause::rig_bumped, "a camera bumped on the way", 2, false, bumped},
};

}  // namespace

std::span<const Fault> rig_faults() { return kFaults; }

}  // namespace waymark::bench
