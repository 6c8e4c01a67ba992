#include "core/base/same_file.h"

#include <system_error>

namespace waymark {
namespace {

namespace fs = std::filesystem;

fs::path place_of(const fs::path& path) {
  std::error_code failed;
  const fs::path absolute = fs::absolute(path, failed);
  const fs::path written = (failed ? path : absolute).lexically_normal();
  const fs::path resolved = fs::weakly_canonical(written, failed);
  return failed ? written : resolved;
}

}  // namespace

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
