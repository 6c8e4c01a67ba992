#include "core/base/priority_mutex.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

TEST(PriorityMutex, ExcludesEverybodyElse) {
  PriorityMutex mutex;
  int count = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 10'000; ++i) {
        const std::lock_guard lock(mutex);
        ++count;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(count, 40'000);
  const std::lock_guard lock(mutex);
  std::thread([&] { EXPECT_FALSE(mutex.try_lock()); }).join();
}

TEST(PriorityMutex, IsOfTheProtocolThatInheritsPriority) {
  constexpr int kInherits = 32;  // as the C library keeps what pthread_mutexattr_setprotocol said
  PriorityMutex mutex;
  EXPECT_NE(mutex.native_handle()->__data.__kind & kInherits, 0);
  pthread_mutex_t ordinary = PTHREAD_MUTEX_INITIALIZER;
  EXPECT_EQ(ordinary.__data.__kind & kInherits, 0);
}

/// The priority at which a thread of this process runs at the moment, as the kernel tells it: 20
/// and thereabouts for ordinary threads, −1 − p for one at p on SCHED_FIFO.
int effective_priority(pid_t thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/stat");
  std::string text;
  std::getline(file, text);
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  constexpr int kPriority = 16;  // of the fields behind the name
  std::string field;
  for (int i = 0; i < kPriority; ++i) fields >> field;
  return std::stoi(field);
}

TEST(PriorityMutex, ItsHolderRunsAtThePriorityOfWhoWaits) {
  constexpr int kFifo = 30;
  PriorityMutex mutex;
  std::atomic<pid_t> holder{0};
  std::atomic<bool> release{false};
  std::thread ordinary([&] {
    const std::lock_guard lock(mutex);
    holder = ::gettid();
    holder.notify_all();
    release.wait(false);
  });
  holder.wait(0);
  EXPECT_GE(effective_priority(holder), 0);
  std::atomic<int> refused{0};
  std::thread realtime([&] {
    sched_param parameters{};
    parameters.sched_priority = kFifo;
    refused = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
    const std::lock_guard lock(mutex);
  });
  const auto deadline = Clock::now() + seconds(10);
  bool inherited = false;
  while (!inherited && refused == 0 && Clock::now() < deadline) {
    inherited = effective_priority(holder) == -1 - kFifo;
    std::this_thread::yield();
  }
  release = true;
  release.notify_all();
  ordinary.join();
  realtime.join();
  if (refused != 0) GTEST_SKIP() << "SCHED_FIFO is not permitted here: " << std::strerror(refused);
  EXPECT_TRUE(inherited);
}

TEST(PriorityCondition, WakesWhoWaits) {
  PriorityMutex mutex;
  PriorityCondition changed;
  bool ready = false;
  std::thread waiter([&] {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return ready; });
  });
  std::thread other([&] {
    std::unique_lock lock(mutex);
    EXPECT_TRUE(changed.wait_until(lock, Clock::now() + seconds(20), [&] { return ready; }));
  });
  {
    const std::lock_guard lock(mutex);
    ready = true;
    changed.notify_all();
  }
  waiter.join();
  other.join();
}

TEST(PriorityCondition, WaitsUntilTheDeadlineAndNotBeyond) {
  PriorityMutex mutex;
  PriorityCondition changed;
  std::unique_lock lock(mutex);
  const auto begun = Clock::now();
  const auto until = begun + milliseconds(30);
  EXPECT_FALSE(changed.wait_until(lock, until, [] { return false; }));
  EXPECT_GE(Clock::now(), until);
  EXPECT_LT(Clock::now(), begun + seconds(10));
  EXPECT_FALSE(changed.wait_until(lock, begun - seconds(1), [] { return false; }));
  EXPECT_TRUE(changed.wait_until(lock, begun - seconds(1), [] { return true; }));
}

}  // namespace
}  // namespace waymark
