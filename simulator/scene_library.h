#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// A scene file that the program carries within it.
struct BuiltinScene {
  std::string_view name;  ///< "room1"
  std::string_view toml;
};

/// All of simulator/scenes/*.toml, by name.
[[nodiscard]] const std::vector<BuiltinScene>& builtin_scenes();

/// A warehouse by formula: `aisles` (even, 2…100) of 32 m between shelves, 200 markers to the aisle
/// of a family that has ids enough, a way to and fro through all of them; 5 positions per marker.
/// Text of a scene file.
[[nodiscard]] std::string aisles_scene(int aisles);

/// A built-in scene by its name, "aislesN" for the warehouse of N aisles, else a scene file.
/// no_input when it is none of these.
[[nodiscard]] Expected<Scene> load_scene(const std::string& name_or_file);

}  // namespace waymark::simulator
