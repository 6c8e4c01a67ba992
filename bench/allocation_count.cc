#include "bench/allocation_count.h"

#include <atomic>
#include <cstdlib>
#include <new>

// The C library's own entry points, which the interposed ones end in, and the program's text.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
extern char __executable_start;  // NOLINT(bugprone-reserved-identifier)
extern char etext;
}

namespace waymark::bench {
namespace {

std::atomic<std::uint64_t> ours{0};
std::atomic<std::uint64_t> libraries{0};

void count(const void* caller) {
  const auto* address = static_cast<const char*>(caller);
  const bool own = address >= &__executable_start && address < &etext;
  (own ? ours : libraries).fetch_add(1, std::memory_order_relaxed);
}

void* take(std::size_t size) {
  void* block = __libc_malloc(size);
  if (block == nullptr) std::abort();
  return block;
}

}  // namespace

AllocationCount allocations() { return {ours.load(), libraries.load()}; }

}  // namespace waymark::bench

extern "C" {
void* malloc(std::size_t size) {
  waymark::bench::count(__builtin_return_address(0));
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  waymark::bench::count(__builtin_return_address(0));
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  waymark::bench::count(__builtin_return_address(0));
  return __libc_realloc(block, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  waymark::bench::count(__builtin_return_address(0));
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? 12 : 0;
}
}

void* operator new(std::size_t size) {
  waymark::bench::count(__builtin_return_address(0));
  return waymark::bench::take(size);
}
void* operator new[](std::size_t size) {
  waymark::bench::count(__builtin_return_address(0));
  return waymark::bench::take(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  waymark::bench::count(__builtin_return_address(0));
  return __libc_memalign(static_cast<std::size_t>(alignment), size);
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete[](void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t /*size*/) noexcept { std::free(block); }
void operator delete[](void* block, std::size_t /*size*/) noexcept { std::free(block); }
void operator delete(void* block, std::align_val_t /*alignment*/) noexcept { std::free(block); }
void operator delete(void* block, std::size_t /*size*/, std::align_val_t /*alignment*/) noexcept {
  std::free(block);
}
