#include "core/base/fingerprint.h"

#include <fmt/format.h>
#include <xxhash.h>

namespace waymark {

std::string Fingerprint::hexadecimal() const {
  return fmt::format("{:016x}", XXH3_64bits(bytes_.data(), bytes_.size()));
}

}  // namespace waymark
