#include "locd/frames/realtime.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <thread>
#include <vector>

namespace waymark {
namespace {

/// AddressSanitizer and ThreadSanitizer bring a heap of their own and let no memory be locked.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kHeapOfASanitizer = true;
#else
constexpr bool kHeapOfASanitizer = false;
#endif

/// Gives up, in a process of its own, whatever would permit real time and locked memory.
void give_up_rights() {
  const rlimit none{0, 0};
  if (::setrlimit(RLIMIT_RTPRIO, &none) != 0 || ::setrlimit(RLIMIT_MEMLOCK, &none) != 0) ::_exit(2);
  constexpr uid_t kNobody = 65534;
  if (::geteuid() == 0 && ::setresuid(kNobody, kNobody, kNobody) != 0) ::_exit(2);
}

[[noreturn]] void end_with(const Status& status) {
  std::fputs(status ? "permitted" : status.error().message.c_str(), stderr);
  ::_exit(status ? 0 : status.error().exit_code());
}

TEST(RealtimeDeathTest, WhatTheSystemDoesNotPermitIsSaidWithWhatToInstall) {
  EXPECT_EXIT((give_up_rights(), end_with(check_realtime())), testing::ExitedWithCode(78),
              "realtime = true.*not permitted.*/usr/share/waymark-locd/realtime.conf");
}

TEST(RealtimeDeathTest, MemoryThatMayNotBeLockedIsSaidWithWhatToSet) {
  if (kHeapOfASanitizer) GTEST_SKIP() << "not with the heap of a sanitizer";
  EXPECT_EXIT((give_up_rights(), end_with(lock_memory())), testing::ExitedWithCode(78),
              "lock_memory = true.*LimitMEMLOCK=infinity");
}

/// kB of this process in RAM.
long resident_kb() {
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  long total = 0;
  long pages = 0;
  const bool read = file != nullptr && std::fscanf(file, "%ld %ld", &total, &pages) == 2;
  if (file != nullptr) std::fclose(file);
  return read ? pages * (::sysconf(_SC_PAGESIZE) / 1024) : 0;
}

/// How much of 64 MB, taken, written and given back, stays with the process (kB).
long kept_kb() {
  const long before = resident_kb();
  {
    std::vector<std::vector<char>> blocks;
    for (int i = 0; i < 64; ++i) blocks.emplace_back(std::size_t{1} << 20, '\1');
  }
  return resident_kb() - before;
}

TEST(RealtimeDeathTest, TheHeapIsKeptWhenAsked) {
  if (kHeapOfASanitizer) GTEST_SKIP() << "not with the heap of a sanitizer";
  constexpr long kHalf_kb = 32 * 1024;
  EXPECT_EXIT(::_exit(kept_kb() < kHalf_kb ? 0 : 1), testing::ExitedWithCode(0), "");
  EXPECT_EXIT((keep_heap(0), ::_exit(kept_kb() > kHalf_kb ? 0 : 1)), testing::ExitedWithCode(0),
              "");
}

TEST(RealtimeDeathTest, TheHeapHasItsReserveAtOnce) {
  if (kHeapOfASanitizer) GTEST_SKIP() << "not with the heap of a sanitizer";
  constexpr std::size_t kReserve = std::size_t{64} << 20;
  const auto grows_kb = [] {
    const long before = resident_kb();
    keep_heap(kReserve);
    return resident_kb() - before;
  };
  EXPECT_EXIT(::_exit(grows_kb() > 60 * 1024 ? 0 : 1), testing::ExitedWithCode(0), "");
}

TEST(Realtime, AThreadThatWasPermittedRunsOnFifo) {
  int policy = -1;
  Status permitted;
  std::thread([&] {
    permitted = make_realtime(kLocalizationPriority);
    sched_param parameters{};
    ::pthread_getschedparam(::pthread_self(), &policy, &parameters);
    EXPECT_EQ(parameters.sched_priority, permitted ? kLocalizationPriority : 0);
  }).join();
  EXPECT_EQ(policy, permitted ? SCHED_FIFO : SCHED_OTHER);
  EXPECT_EQ(check_realtime().has_value(), permitted.has_value());
}

TEST(Realtime, ThreadsAreNamedByTheFirstFifteenLetters) {
  std::array<char, 32> name{};
  std::thread([&] {
    name_thread("localization of a rig");
    ::pthread_getname_np(::pthread_self(), name.data(), name.size());
  }).join();
  EXPECT_STREQ(name.data(), "localization of");
}

}  // namespace
}  // namespace waymark
