#include "simulator/scene_library.h"

#include <filesystem>

#include "simulator/scene_file.h"

namespace waymark::simulator {

Expected<Scene> load_scene(const std::string& name_or_file) {
  std::vector<std::string_view> names;
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (scene.name == name_or_file) {
      return parse_scene(scene.toml, fmt::format("scenes/{}.toml", scene.name));
    }
    names.push_back(scene.name);
  }
  std::error_code ignored;
  if (!std::filesystem::exists(name_or_file, ignored)) {
    return fail(ErrorKind::no_input, "scene \"{}\": neither a built-in scene ({}) nor a file",
                name_or_file, fmt::join(names, " "));
  }
  return read_scene(name_or_file);
}

}  // namespace waymark::simulator
