#pragma once

#include <filesystem>
#include <string>

#include "core/base/atomic_file.h"

namespace waymark::test {

inline constexpr std::size_t kContainerHeaderBytes = 24;  ///< before the records

/// A map file as that version of the container wrote it.
[[nodiscard]] inline std::string golden_map(int version) {
  const auto name = "version_" + std::to_string(version) + ".map";
  return read_file(std::filesystem::path(WAYMARK_GOLDEN_MAPS) / name, 1 << 20).value();
}

}  // namespace waymark::test
