#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "bench/cause_variants/faults.h"
#include "core/geometry/so3.h"

namespace waymark::bench {

using simulator::Random;

std::set<std::string> every_camera(const World& world) {
  std::set<std::string> names;
  for (const RigCamera& camera : world.rig.cameras) names.insert(camera.name);
  return names;
}

std::set<std::string> one_or_either(const World& world, std::size_t camera) {
  if (world.cameras() == 2) return every_camera(world);
  return {world.rig.cameras[camera].name};
}

double either_sign(double least, double most, Random& random) {
  const double amount = random.uniform(least, most);
  return random.uniform() < 0.5 ? -amount : amount;
}

std::vector<std::size_t> often_seen(const World& world, int sights, std::size_t count,
                                    Random& random) {
  const auto seen = sights_of(world, seen_images(world));
  std::vector<std::size_t> often;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] >= sights) often.push_back(i);
  }
  for (std::size_t i = 0; i + 1 < often.size(); ++i) {
    std::swap(often[i], often[i + random.below(often.size() - i)]);
  }
  if (often.size() > count) often.resize(count);
  return often;
}

std::optional<Measured> measure(const World& world, Random& random) {
  constexpr std::size_t kPoints = 7;
  constexpr int kSights = 6;
  constexpr double kNoise_m = 0.003;
  const auto markers = often_seen(world, kSights, kPoints, random);
  if (markers.size() < kPoints) return std::nullopt;
  const auto at = [&](std::size_t marker) {
    return world.scene.markers[marker].world_from_marker.translation;
  };
  Measured measured;
  for (const std::size_t marker : markers) {
    measured.points.push_back(
        {marker, at(marker) + kNoise_m * Eigen::Vector3d(random.normal(), random.normal(),
                                                         random.normal())});
  }
  for (std::size_t i = 0; measured.distances.size() < 3 && i + 1 < kPoints; ++i) {
    const double distance_m = (at(markers[i]) - at(markers[i + 1])).norm();
    constexpr double kShort_m = 1.0;
    if (distance_m < kShort_m) continue;
    measured.distances.push_back(
        {markers[i], markers[i + 1], distance_m + kNoise_m * random.normal()});
  }
  if (measured.distances.size() < 3) return std::nullopt;
  return measured;
}

std::string survey_toml(const World& world, const Measured& measured, const char* corner) {
  const auto number = [&](std::size_t marker) { return world.scene.markers[marker].id.number; };
  std::string text;
  for (const auto& point : measured.points) {
    text += fmt::format(
        "[[points]]\nid = {}\ncorner = \"{}\"\nposition_m = [{:.4f}, {:.4f}, {:.4f}]\n"
        "sigma_m = 0.003\n",
        number(point.marker), corner, point.position_m.x(), point.position_m.y(),
        point.position_m.z());
  }
  for (const auto& distance : measured.distances) {
    text += fmt::format(
        "[[distances]]\nfrom = {{ id = {}, corner = \"center\" }}\nto = {{ id = {}, corner = "
        "\"center\" }}\ndistance_m = {:.4f}\nsigma_m = 0.003\n",
        number(distance.from), number(distance.to), distance.distance_m);
  }
  return text;
}

HandMap measured_map(const World& world, Random& random) {
  constexpr double kNoise_m = 0.003;
  constexpr double kNoise_rad = 0.2 * std::numbers::pi / 180;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma *
                           Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
  };
  HandMap map;
  for (const auto& marker : world.scene.markers) {
    const Rigid3& x = marker.world_from_marker;
    map.entries.push_back(
        {marker.id,
         marker.size_m,
         {x.rotation * so3_exp(noise(kNoise_rad)), x.translation + noise(kNoise_m)}});
  }
  return map;
}

std::string hall_json(const HandMap& map) {
  std::string text = R"({"schema": 1, "submaps": [{"frame": "facility", "markers": [)";
  for (std::size_t i = 0; i < map.entries.size(); ++i) {
    const auto& [id, size_m, x] = map.entries[i];
    text += fmt::format(
        "{}{{\"id\": {}, \"family\": \"{}\", \"size_m\": {:.4f}, \"position_m\": [{:.4f}, {:.4f}, "
        "{:.4f}], \"quaternion_xyzw\": [{:.9f}, {:.9f}, {:.9f}, {:.9f}], \"sigma_m\": 0.003, "
        "\"sigma_deg\": 0.3}}",
        i == 0 ? "" : ", ", id.number, name_of(id.family), size_m, x.translation.x(),
        x.translation.y(), x.translation.z(), x.rotation.x(), x.rotation.y(), x.rotation.z(),
        x.rotation.w());
  }
  return text + "]}]}\n";
}

std::vector<Fault> all_faults() {
  std::vector<Fault> all;
  for (const auto faults : {input_faults(), time_faults(), rig_faults(), lens_faults(),
                            size_faults(), marker_faults(), map_faults(), survey_faults()}) {
    all.insert(all.end(), faults.begin(), faults.end());
  }
  return all;
}

std::span<const NotShown> not_shown() {
  static constexpr NotShown kNotShown[] = {
      {Cause::mirrored, "seen in images: a mirrored code gives no corners"},
      {Cause::inverted_print, "seen in images"},
      {Cause::border, "seen in images"},
      {Cause::margin, "seen in images"},
      {Cause::dark, "seen in images"},
      {Cause::response, "seen in grey values"},
  };
  return kNotShown;
}

namespace {

constexpr RigKind kRigs[] = {RigKind::cg60, RigKind::cg120, RigKind::fisheye, RigKind::mono};

std::size_t cameras_of(RigKind kind) {
  return kind == RigKind::mono ? 1 : kind == RigKind::fisheye ? 2 : 3;
}

/// FNV-1a: rows keep their draws when others come before them.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

}  // namespace

Variant draw_variant(const Fault& fault, int number) {
  std::vector<RigKind> rigs;
  for (const RigKind kind : kRigs) {
    if (cameras_of(kind) >= fault.cameras) rigs.push_back(kind);
  }
  const auto count = static_cast<int>(rigs.size());
  for (std::uint64_t attempt = 0;; ++attempt) {
    Random random = Random::of({hash_of(fault.name), static_cast<std::uint64_t>(number), attempt});
    Variant variant;
    const bool driving = fault.driving || random.uniform() < 0.3;
    // Where one rig or scene does not show it, the next ones are tried.
    const auto shift = static_cast<int>(attempt);
    const int scene = number + number / count + shift;
    variant.worlds.push_back(draw_world(
        rigs[static_cast<std::size_t>(number + shift) % rigs.size()], scene, driving, random));
    if (is_well_seen(variant.world()) && fault.commit(variant, random)) return variant;
  }
}

Variant draw_sound(int number) {
  for (int attempt = 0;; ++attempt) {
    Random random = Random::of({hash_of("sound"), static_cast<std::uint64_t>(number),
                                static_cast<std::uint64_t>(attempt)});
    Variant variant;
    const RigKind kind = kRigs[static_cast<std::size_t>(number % 4)];
    variant.worlds.push_back(
        draw_world(kind, number + number / 4 + attempt, random.uniform() < 0.5, random));
    const World& world = variant.world();
    if (!is_well_seen(world)) continue;
    variant.truth.exits = {0};
    const auto measured = number % 3 == 0 ? measure(world, random) : std::nullopt;
    if (measured) variant.survey_toml = survey_toml(world, *measured);
    if (number % 7 == 1) variant.hand_map_json = hall_json(measured_map(world, random));
    return variant;
  }
}

}  // namespace waymark::bench
