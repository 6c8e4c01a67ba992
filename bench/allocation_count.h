#pragma once

#include <cstdint>

namespace waymark::bench {

/// Heap allocations of this process since its start, by who asked: the program's own code (its
/// libraries are static), or a shared library. Counted by interposed malloc and operator new.
struct AllocationCount {
  std::uint64_t ours = 0;
  std::uint64_t libraries = 0;
};
[[nodiscard]] AllocationCount allocations();

}  // namespace waymark::bench
