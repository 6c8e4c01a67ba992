#include "tests/support/allocation_count.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<long> taken = 0;
}  // namespace

#if defined(__GNUC__) && !defined(__clang__)
// Where GCC inlines only one of the pair it sees new's block given to free.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
#endif
// NOLINTBEGIN(cppcoreguidelines-no-malloc): what the standard's own do, counted
void* operator new(std::size_t size) {
  ++taken;
  if (void* const block = std::malloc(size)) return block;
  throw std::bad_alloc();
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t /*size*/) noexcept { std::free(block); }
// NOLINTEND(cppcoreguidelines-no-malloc)

namespace waymark::testing {

long allocations() { return taken; }

}  // namespace waymark::testing
