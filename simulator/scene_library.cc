#include "simulator/scene_library.h"

#include <charconv>
#include <filesystem>
#include <optional>

#include "core/base/is_there.h"
#include "simulator/scene_file.h"

namespace waymark::simulator {
namespace {

constexpr std::string_view kAislesPrefix = "aisles";
constexpr int kMostAisles = 100;

/// N of "aislesN".
std::optional<int> aisles_of(std::string_view name) {
  if (!name.starts_with(kAislesPrefix)) return std::nullopt;
  name.remove_prefix(kAislesPrefix.size());
  int aisles = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), aisles);
  if (error != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  return aisles;
}

}  // namespace

std::string aisles_scene(int aisles) {
  // Shelves of 1 m between aisles of 4 m: shelf i fills y = 4 + 5 i … 5 + 5 i, and there is one
  // less than aisles.
  constexpr double kPitch_m = 5.0;
  const double width_m = kPitch_m * aisles - 1.0;
  const int markers = 200 * aisles - 200 + 2 * 100;
  std::string text = fmt::format(R"(name = "aisles{0}"
title = "Warehouse of {0} aisles"
seed = {0}
room_size_m = [44.0, {1:.1f}, 4.0]

[markers]
family = "tagstandard52h13"
size_m = 0.30
[[ids]]
first = 0
last = {2}

[[boxes]]
name = "shelf"
min_m = [6.0, 4.0, 0.0]
max_m = [38.0, 5.0, 2.8]
repeat = {3}
step_m = [0.0, {4:.1f}, 0.0]
)",
                                 aisles, width_m, markers - 1, aisles - 1, kPitch_m);
  for (const char* face : {"shelf*.south", "shelf*.north", "room.south", "room.north"}) {
    fmt::format_to(std::back_inserter(text), R"(
[[marker_grids]]
on = "{}"
rows_m = [0.85, 1.65]
columns = 50
margin_left_m = {}
margin_right_m = {}
stagger_m = 0.3
)",
                   face, face[0] == 's' ? 0.3 : 6.3, face[0] == 's' ? 0.6 : 6.6);
  }
  fmt::format_to(std::back_inserter(text), R"(
[trajectory]
positions = {}
speed_mps = 1.5
waypoints = [
)",
                 5 * markers);
  // Back along the western end, then aisle after aisle.
  for (int aisle = aisles - 1; aisle >= 0; aisle -= 2) {
    fmt::format_to(std::back_inserter(text), "  {{ at_m = [1.8, {:.1f}, 1.25] }},\n",
                   kPitch_m * aisle + 1.0);
  }
  fmt::format_to(std::back_inserter(text), R"(]
[[trajectory.lanes]]
first_m = [3.5, 2.0, 1.25]
along_m = [37.0, 0.0, 0.0]
step_m = [0.0, {:.1f}, 0.0]
count = {}
points_per_lane = 11
sway_deg = 25
)",
                 kPitch_m, aisles);
  return text;
}

Expected<Scene> load_scene(const std::string& name_or_file) {
  std::vector<std::string_view> names;
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (scene.name == name_or_file) {
      return parse_scene(scene.toml, fmt::format("scenes/{}.toml", scene.name));
    }
    names.push_back(scene.name);
  }
  if (const auto aisles = aisles_of(name_or_file)) {
    if (*aisles < 2 || *aisles > kMostAisles || *aisles % 2 != 0) {
      return fail(ErrorKind::usage, "scene \"{}\": the number of aisles must be even, 2 to {}",
                  name_or_file, kMostAisles);
    }
    return parse_scene(aisles_scene(*aisles), name_or_file);
  }
  if (!is_there(name_or_file)) {
    return fail(ErrorKind::no_input,
                "scene \"{}\": neither a built-in scene ({} aislesN) nor a file", name_or_file,
                fmt::join(names, " "));
  }
  return read_scene(name_or_file);
}

}  // namespace waymark::simulator
