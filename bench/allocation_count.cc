#include "bench/allocation_count.h"

#include <link.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <new>
#include <string_view>

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
std::atomic<std::uint64_t> opencv{0};
std::atomic<std::uint64_t> lcm{0};
std::atomic<std::uint64_t> others{0};

/// Code of a library and whose count it belongs to. A fixed table: allocating here would not end.
struct Code {
  const char* begin = nullptr;
  const char* end = nullptr;
  std::atomic<std::uint64_t>* count = nullptr;
};
std::array<Code, 128> codes;
std::atomic<std::size_t> code_count{0};

std::atomic<std::uint64_t>* count_of(std::string_view library) {
  if (library.find("libopencv") != library.npos) return &opencv;
  if (library.find("liblcm") != library.npos || library.find("libglib") != library.npos) {
    return &lcm;
  }
  return nullptr;
}

int note_library(dl_phdr_info* info, std::size_t /*size*/, void* /*data*/) {
  auto* count = count_of(info->dlpi_name);
  for (int i = 0; count != nullptr && i < info->dlpi_phnum; ++i) {
    const auto& part = info->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0 || code_count == codes.size())
      continue;
    const auto* begin = reinterpret_cast<const char*>(info->dlpi_addr + part.p_vaddr);
    codes[code_count] = {begin, begin + part.p_memsz, count};
    ++code_count;
  }
  return 0;
}

void count(const void* caller) {
  const auto* address = static_cast<const char*>(caller);
  std::atomic<std::uint64_t>* whose = &others;
  if (address >= &__executable_start && address < &etext) {
    whose = &ours;
  } else {
    for (std::size_t i = 0; i < code_count; ++i) {
      if (address >= codes[i].begin && address < codes[i].end) whose = codes[i].count;
    }
  }
  whose->fetch_add(1, std::memory_order_relaxed);
}

void* take(std::size_t size) {
  void* block = __libc_malloc(size);
  if (block == nullptr) std::abort();
  return block;
}

}  // namespace

AllocationCount allocations() { return {ours.load(), opencv.load(), lcm.load(), others.load()}; }

void tell_libraries_apart() { ::dl_iterate_phdr(note_library, nullptr); }

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
