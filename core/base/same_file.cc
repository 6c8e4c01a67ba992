#include "core/base/same_file.h"

#include <system_error>

namespace waymark {
namespace {

namespace fs = std::filesystem;

fs::path place_of(const fs::path& path) {
  std::error_code failed;
  const fs::path leads_to = behind_links(path).value_or(path);
  const fs::path absolute = fs::absolute(leads_to, failed);
  const fs::path written = (failed ? leads_to : absolute).lexically_normal();
  const fs::path resolved = fs::weakly_canonical(written, failed);
  return failed ? written : resolved;
}

}  // namespace

std::optional<fs::path> behind_links(const fs::path& named) {
  constexpr int kMostLinks = 40;  // Linux's own limit
  fs::path path = named;
  for (int links = 0; links <= kMostLinks; ++links) {
    std::error_code why;
    if (!fs::is_symlink(path, why)) return path;
    const fs::path target = fs::read_symlink(path, why);
    if (why) return path;
    path = target.is_absolute() ? target : path.parent_path() / target;
  }
  return std::nullopt;
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code unknown;
  return fs::equivalent(a, b, unknown) || place_of(a) == place_of(b);
}

bool is_within(const fs::path& path, const fs::path& folder) {
  fs::path place = place_of(path);
  while (place.has_relative_path()) {
    place = place.parent_path();
    if (is_same_file(place, folder)) return true;
  }
  return false;
}

}  // namespace waymark
