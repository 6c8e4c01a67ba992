#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <limits>
#include <string>

#include "tests/support/sanitized.h"

namespace waymark::test {

/// A field of /proc/self/status that is a number of kB, in bytes.
inline std::size_t status_bytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string name; status >> name;) {
    std::size_t kilobytes = 0;
    if (name == field + ":" && status >> kilobytes) return kilobytes * 1024;
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  ADD_FAILURE() << field << " is not told";
  return 0;
}

/// Bytes of memory that `work` has at most beside those that were taken before, as the system
/// counts them: whoever asks for them, this program or a library of C. 0 under a sanitizer.
template <typename Work>
std::size_t peak_memory(const Work& work) {
  if (kSanitized) {
    work();
    return 0;
  }
  EXPECT_TRUE(std::ofstream("/proc/self/clear_refs") << "5" << std::flush);  // forgets the peak
  const std::size_t before = status_bytes("VmRSS");
  work();
  const std::size_t most = status_bytes("VmHWM");
  return most > before ? most - before : 0;
}

}  // namespace waymark::test
