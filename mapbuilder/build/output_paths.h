#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace waymark {

/// `out.tum` beside which another file goes: `out.MARK.tum`.
[[nodiscard]] inline std::filesystem::path path_beside(const std::filesystem::path& path,
                                                       const std::string& mark) {
  std::filesystem::path name = path.stem();
  name += "." + mark;
  name += path.extension();
  return path.parent_path() / name;
}

/// Where sub-map `index`'s file goes: the first to the named file, `out.tum`, the others beside it,
/// `out.1.tum`, `out.2.tum`…
[[nodiscard]] inline std::filesystem::path path_of_submap(const std::filesystem::path& path,
                                                          std::size_t index) {
  return index == 0 ? path : path_beside(path, std::to_string(index));
}

/// Where a capture's own trajectory goes: of the first that was given to the named file, of the
/// others beside it, `out.capture1.tum`, `out.capture2.tum`…; of sub-map 1 `out.capture1.1.tum`.
[[nodiscard]] inline std::filesystem::path path_of_capture(const std::filesystem::path& path,
                                                           std::size_t place) {
  return place == 0 ? path : path_beside(path, "capture" + std::to_string(place));
}

/// Where a camera's own trajectory (--mono) goes: `out.cam0.tum`; of sub-map 1, `out.1.cam0.tum`.
[[nodiscard]] inline std::filesystem::path path_of_camera(const std::filesystem::path& path,
                                                          const std::string& camera) {
  return path_beside(path, camera);
}

/// Where a map goes that must not be used.
[[nodiscard]] inline std::filesystem::path rejected_path(const std::filesystem::path& map) {
  std::filesystem::path rejected = map;
  rejected += ".rejected";
  return rejected;
}

/// MAP.info: what mapbuilder knows of a map beside what it holds.
[[nodiscard]] inline std::filesystem::path info_path(const std::filesystem::path& map) {
  std::filesystem::path info = map;
  info += ".info";
  return info;
}

/// What may be written beside a map.
[[nodiscard]] inline std::vector<std::filesystem::path> paths_beside_map(
    const std::filesystem::path& map) {
  const std::filesystem::path rejected = rejected_path(map);
  return {info_path(map), rejected, info_path(rejected)};
}

}  // namespace waymark
