#include "core/base/error.h"

namespace waymark {

std::string line_of(const Error& error, std::string_view program) {
  if (error.cause) return fmt::format("error [{}] {}", name_of(*error.cause), error.message);
  return fmt::format("{}: {}", program, error.message);
}

}  // namespace waymark
