#pragma once

#include <pthread.h>

#include <chrono>
#include <mutex>

namespace waymark {

/// A mutex whose holder runs, while a thread of higher real-time priority waits for it, at that
/// thread's priority (PTHREAD_PRIO_INHERIT): for what threads on SCHED_FIFO share with ordinary
/// ones, which anybody may keep from running. Used as std::mutex is.
class PriorityMutex {
 public:
  PriorityMutex();
  ~PriorityMutex();
  PriorityMutex(const PriorityMutex&) = delete;
  PriorityMutex& operator=(const PriorityMutex&) = delete;

  void lock();
  void unlock();
  [[nodiscard]] bool try_lock();
  [[nodiscard]] pthread_mutex_t* native_handle() { return &mutex_; }

 private:
  pthread_mutex_t mutex_{};
};

/// A condition variable for it, on CLOCK_MONOTONIC. std::condition_variable_any would do, but holds
/// an ordinary mutex of its own.
class PriorityCondition {
 public:
  PriorityCondition() = default;
  ~PriorityCondition();
  PriorityCondition(const PriorityCondition&) = delete;
  PriorityCondition& operator=(const PriorityCondition&) = delete;

  void notify_all();
  /// Until notified; `until` passed; or for no reason.
  void wait(std::unique_lock<PriorityMutex>& lock);
  void wait_until(std::unique_lock<PriorityMutex>& lock,
                  std::chrono::steady_clock::time_point until);

  template <typename Holds>
  void wait(std::unique_lock<PriorityMutex>& lock, const Holds& holds) {
    while (!holds()) wait(lock);
  }
  /// Whether it holds at last.
  template <typename Holds>
  bool wait_until(std::unique_lock<PriorityMutex>& lock,
                  std::chrono::steady_clock::time_point until, const Holds& holds) {
    while (!holds()) {
      if (std::chrono::steady_clock::now() >= until) return false;
      wait_until(lock, until);
    }
    return true;
  }

 private:
  pthread_cond_t condition_ = PTHREAD_COND_INITIALIZER;
};

}  // namespace waymark
