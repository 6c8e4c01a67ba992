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

/// A built-in scene by its name, else a scene file. no_input when it is neither.
[[nodiscard]] Expected<Scene> load_scene(const std::string& name_or_file);

}  // namespace waymark::simulator
