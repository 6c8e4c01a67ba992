#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/range.h"

namespace waymark {

/// How many threads may be asked for; 0: as many as there are processors.
inline constexpr Range kThreads{0, 1024};

/// Calls `body(state, i)` for every i in [0, count) on up to `threads` threads, each with a working
/// state of its own from `make_state()`. Each i is called exactly once and must write only to its
/// own slot: then the result does not depend on the number of threads. The first exception is
/// rethrown after all threads have ended.
template <typename MakeState, typename Body>
void parallel_for_with(std::size_t count, int threads, const MakeState& make_state,
                       const Body& body) {
  const std::size_t workers =
      std::min<std::size_t>(count, static_cast<std::size_t>(std::max(1, threads)));
  if (workers <= 1) {
    auto state = make_state();
    for (std::size_t i = 0; i < count; ++i) body(state, i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr first_failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    try {
      auto state = make_state();
      for (std::size_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) body(state, i);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!first_failure) first_failure = std::current_exception();
      next.store(count);
    }
  };
  {
    std::vector<std::jthread> pool;
    pool.reserve(workers - 1);
    for (std::size_t i = 1; i < workers; ++i) pool.emplace_back(work);
    work();
  }
  if (first_failure) std::rethrow_exception(first_failure);
}

/// The same without a working state: `body(i)`.
template <typename Body>
void parallel_for(std::size_t count, int threads, const Body& body) {
  struct Nothing {};
  parallel_for_with(
      count, threads, [] { return Nothing{}; },
      [&](Nothing& /*state*/, std::size_t i) { body(i); });
}

/// Number of threads that "0 = all processors" means here, at least 1.
[[nodiscard]] inline int effective_threads(int requested) {
  if (requested > 0) return requested;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace waymark
