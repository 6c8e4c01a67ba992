#include "simulator/scene_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "simulator/random.h"

namespace waymark::simulator {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Thickness of the plate a marker is printed on, and of the glue.
constexpr double kPlateThickness_m = 0.004;

/// A plate is the marker and its white margin, one cell of at most a sixth of the side all round.
constexpr double kPlatePerSide = 1.34;

/// A face of an upright surface, seen along −normal.
Surface upright(std::string name, const Eigen::Vector3d& lower_left, const Eigen::Vector3d& normal,
                double width_m, double height_m) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  return {std::move(name), lower_left, up.cross(normal), up, width_m, height_m};
}

/// `*` matches any run of characters.
bool matches(std::string_view pattern, std::string_view text) {
  const auto star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == text;
  if (text.substr(0, star) != pattern.substr(0, star)) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t skip = star; skip <= text.size(); ++skip) {
    if (matches(rest, text.substr(skip))) return true;
  }
  return false;
}

/// Where a marker hangs, before it has an id.
struct Place {
  int surface;
  double across_m, above_m;
  double roll_rad, tilt_x_rad, tilt_y_rad;
};

void add_places(const Surface& surface, int index, const MarkerGrid& grid, Random& random,
                std::vector<Place>& places) {
  const double usable_m = surface.width_m - grid.margin_left_m - grid.margin_right_m;
  const double step_m = grid.columns > 1 ? usable_m / (grid.columns - 1) : 0.0;
  const double first_m = grid.margin_left_m + (grid.columns > 1 ? 0.0 : usable_m / 2);
  for (std::size_t row = 0; row < grid.rows_m.size(); ++row) {
    const double shift_m = row % 2 == 1 ? grid.stagger_m : 0.0;
    for (int column = 0; column < grid.columns; ++column) {
      Place place{};
      place.surface = index;
      place.across_m = first_m + column * step_m + shift_m + grid.jitter_m * random.uniform(-1, 1);
      place.above_m = grid.rows_m[row] + grid.jitter_m * random.uniform(-1, 1);
      place.roll_rad = grid.roll_sigma_deg * kRadPerDeg * random.normal();
      place.tilt_x_rad = grid.tilt_sigma_deg * kRadPerDeg * random.normal();
      place.tilt_y_rad = grid.tilt_sigma_deg * kRadPerDeg * random.normal();
      places.push_back(place);
    }
  }
}

Rigid3 world_from_marker(const Surface& surface, const Place& place, double size_m) {
  Eigen::Matrix3d axes;
  axes << surface.right, surface.up, surface.normal();
  const Eigen::Quaterniond turned = Eigen::AngleAxisd(place.tilt_x_rad, Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(place.tilt_y_rad, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(place.roll_rad, Eigen::Vector3d::UnitZ());
  // A tilted plate touches the wall with its lowest corner.
  const double lift_m = kPlateThickness_m + 0.5 * kPlatePerSide * size_m *
                                                (std::abs(std::sin(place.tilt_x_rad)) +
                                                 std::abs(std::sin(place.tilt_y_rad)));
  return {(Eigen::Quaterniond(axes) * turned).normalized(),
          surface.point(place.across_m, place.above_m) + lift_m * surface.normal()};
}

bool fits(const Surface& surface, const Place& place, double size_m) {
  // A plate that is turned by its roll needs its turned extent, and no corner may hang over.
  const double half_m = 0.5 * kPlatePerSide * size_m *
                        (std::abs(std::cos(place.roll_rad)) + std::abs(std::sin(place.roll_rad)));
  return place.across_m >= half_m && place.across_m <= surface.width_m - half_m &&
         place.above_m >= half_m && place.above_m <= surface.height_m - half_m;
}

/// Two plates of one surface that overlap; neighbours by a grid of plate-sized squares.
std::optional<std::pair<std::size_t, std::size_t>> overlapping(const std::vector<Place>& places,
                                                               const std::vector<double>& size_m) {
  constexpr double kSquare_m = 1.0;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> squares;
  const auto key = [&](const Place& p, int dx, int dy) {
    const auto x = static_cast<std::uint64_t>(std::floor(p.across_m / kSquare_m) + dx + 1);
    const auto y = static_cast<std::uint64_t>(std::floor(p.above_m / kSquare_m) + dy + 1);
    return (static_cast<std::uint64_t>(p.surface) << 40U) | (x << 20U) | y;
  };
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found = squares.find(key(places[i], dx, dy));
        if (found == squares.end()) continue;
        for (const std::size_t j : found->second) {
          const double apart_m = std::max(std::abs(places[i].across_m - places[j].across_m),
                                          std::abs(places[i].above_m - places[j].above_m));
          if (apart_m < 0.5 * kPlatePerSide * (size_m[i] + size_m[j])) return std::pair{j, i};
        }
      }
    }
    squares[key(places[i], 0, 0)].push_back(i);
  }
  return std::nullopt;
}

}  // namespace

std::vector<Surface> room_faces(const Eigen::Vector3d& size_m) {
  const double x = size_m.x();
  const double y = size_m.y();
  const double z = size_m.z();
  return {{"room.floor", {0, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), x, y},
          {"room.ceiling", {0, y, z}, Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY(), x, y},
          upright("room.south", {x, 0, 0}, Eigen::Vector3d::UnitY(), x, z),
          upright("room.east", {x, y, 0}, -Eigen::Vector3d::UnitX(), y, z),
          upright("room.north", {0, y, 0}, -Eigen::Vector3d::UnitY(), x, z),
          upright("room.west", {0, 0, 0}, Eigen::Vector3d::UnitX(), y, z)};
}

std::vector<Surface> box_faces(const Box& box) {
  const Eigen::Vector3d& a = box.min_m;
  const Eigen::Vector3d& b = box.max_m;
  const Eigen::Vector3d size_m = b - a;
  std::vector<Surface> faces = {upright(box.name + ".south", {a.x(), a.y(), a.z()},
                                        -Eigen::Vector3d::UnitY(), size_m.x(), size_m.z()),
                                upright(box.name + ".east", {b.x(), a.y(), a.z()},
                                        Eigen::Vector3d::UnitX(), size_m.y(), size_m.z()),
                                upright(box.name + ".north", {b.x(), b.y(), a.z()},
                                        Eigen::Vector3d::UnitY(), size_m.x(), size_m.z()),
                                upright(box.name + ".west", {a.x(), b.y(), a.z()},
                                        -Eigen::Vector3d::UnitX(), size_m.y(), size_m.z()),
                                {box.name + ".top",
                                 {a.x(), a.y(), b.z()},
                                 Eigen::Vector3d::UnitX(),
                                 Eigen::Vector3d::UnitY(),
                                 size_m.x(),
                                 size_m.y()}};
  if (a.z() > 0) {
    faces.push_back({box.name + ".bottom",
                     {a.x(), b.y(), a.z()},
                     Eigen::Vector3d::UnitX(),
                     -Eigen::Vector3d::UnitY(),
                     size_m.x(),
                     size_m.y()});
  }
  return faces;
}

std::vector<Surface> wall_faces(const std::string& name, const Eigen::Vector3d& from_m,
                                const Eigen::Vector3d& to_m, double top_m) {
  const Eigen::Vector3d along = (to_m - from_m).normalized();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(along);
  const double width_m = (to_m - from_m).norm();
  return {upright(name + ".left", to_m, left, width_m, top_m - from_m.z()),
          upright(name + ".right", from_m, -left, width_m, top_m - from_m.z())};
}

Status place_markers(Scene& scene, const std::vector<MarkerGrid>& grids,
                     std::vector<MarkerId> ids) {
  Random random = Random::of({scene.seed, 1});
  std::vector<Place> places;
  for (const MarkerGrid& grid : grids) {
    const std::size_t before = places.size();
    for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
      if (matches(grid.on, scene.surfaces[i].name)) {
        add_places(scene.surfaces[i], static_cast<int>(i), grid, random, places);
      }
    }
    if (places.size() == before) {
      return fail(ErrorKind::bad_data, "scene {}: no surface is called \"{}\"", scene.name,
                  grid.on);
    }
  }
  if (places.size() != ids.size()) {
    return fail(ErrorKind::bad_data, "scene {}: {} places for markers, but {} ids", scene.name,
                places.size(), ids.size());
  }
  for (std::size_t i = ids.size(); i > 1; --i) std::swap(ids[i - 1], ids[random.below(i)]);
  std::vector<double> size_m;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Surface& surface = scene.surfaces[static_cast<std::size_t>(places[i].surface)];
    const auto size = scene.catalog.size_m(ids[i]);
    if (!size) {
      return fail(ErrorKind::bad_data, "scene {}: marker {} has no size", scene.name,
                  scene.catalog.format(ids[i]));
    }
    if (!fits(surface, places[i], *size)) {
      return fail(
          ErrorKind::bad_data,
          "scene {}: marker {} at ({:.2f}, {:.2f}) m hangs over the edge of {}; move its row "
          "or widen the margins",
          scene.name, scene.catalog.format(ids[i]), places[i].across_m, places[i].above_m,
          surface.name);
    }
    size_m.push_back(*size);
    scene.markers.push_back(
        {ids[i], *size, world_from_marker(surface, places[i], *size), places[i].surface});
  }
  if (const auto pair = overlapping(places, size_m)) {
    return fail(ErrorKind::bad_data, "scene {}: markers {} and {} overlap on {}", scene.name,
                scene.catalog.format(ids[pair->first]), scene.catalog.format(ids[pair->second]),
                scene.surfaces[static_cast<std::size_t>(places[pair->second].surface)].name);
  }
  std::sort(scene.markers.begin(), scene.markers.end(),
            [](const PlacedMarker& a, const PlacedMarker& b) { return a.id < b.id; });
  return {};
}

}  // namespace waymark::simulator
