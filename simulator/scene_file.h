#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// Reads a scene (simulator/scenes/*.toml describe the form). bad_data, with the line where there
/// is one, for unknown keys, numbers out of range, boxes outside the room, markers that do not fit,
/// ids without size or in use twice, and a way that leads through a wall, a box or the room's own
/// walls.
[[nodiscard]] Expected<Scene> parse_scene(std::string_view text, const std::string& name);

/// The same from a file; no_input when absent.
[[nodiscard]] Expected<Scene> read_scene(const std::filesystem::path& path);

}  // namespace waymark::simulator
