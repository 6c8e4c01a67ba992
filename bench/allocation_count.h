#pragma once

#include <cstdint>

namespace waymark::bench {

/// Heap allocations of the process so far, by who called malloc, calloc, realloc, posix_memalign or
/// operator new: code of the program, of OpenCV, of LCM (with GLib), of other libraries.
struct AllocationCount {
  std::uint64_t ours = 0;
  std::uint64_t opencv = 0;
  std::uint64_t lcm = 0;
  std::uint64_t others = 0;
};
[[nodiscard]] AllocationCount allocations();

/// Learns where the libraries' code lies, which must be loaded; before that their allocations count
/// as others'.
void tell_libraries_apart();

}  // namespace waymark::bench
