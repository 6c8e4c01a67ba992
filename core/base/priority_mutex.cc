#include "core/base/priority_mutex.h"

#include <ctime>

#include "core/base/check.h"

namespace waymark {

PriorityMutex::PriorityMutex() {
  pthread_mutexattr_t attributes{};
  WAYMARK_CHECK(::pthread_mutexattr_init(&attributes) == 0);
  WAYMARK_CHECK(::pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT) == 0);
  WAYMARK_CHECK(::pthread_mutex_init(&mutex_, &attributes) == 0);
  ::pthread_mutexattr_destroy(&attributes);
}

PriorityMutex::~PriorityMutex() { ::pthread_mutex_destroy(&mutex_); }

void PriorityMutex::lock() { WAYMARK_CHECK(::pthread_mutex_lock(&mutex_) == 0); }

void PriorityMutex::unlock() { ::pthread_mutex_unlock(&mutex_); }

bool PriorityMutex::try_lock() { return ::pthread_mutex_trylock(&mutex_) == 0; }

PriorityCondition::~PriorityCondition() { ::pthread_cond_destroy(&condition_); }

void PriorityCondition::notify_all() { ::pthread_cond_broadcast(&condition_); }

void PriorityCondition::wait(std::unique_lock<PriorityMutex>& lock) {
  ::pthread_cond_wait(&condition_, lock.mutex()->native_handle());
}

void PriorityCondition::wait_until(std::unique_lock<PriorityMutex>& lock,
                                   std::chrono::steady_clock::time_point until) {
  const auto since_boot = until.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_boot);
  const timespec at{static_cast<std::time_t>(seconds.count()),
                    static_cast<long>(std::chrono::nanoseconds(since_boot - seconds).count())};
  ::pthread_cond_clockwait(&condition_, lock.mutex()->native_handle(), CLOCK_MONOTONIC, &at);
}

}  // namespace waymark
