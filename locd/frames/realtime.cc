#include "locd/frames/realtime.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <system_error>
#include <thread>

#include "core/base/system_call.h"

namespace waymark {

void name_thread(const std::string& name) {
  ::pthread_setname_np(::pthread_self(), name.substr(0, 15).c_str());
}

Status make_realtime(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int failed = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
  if (failed == 0) return {};
  return fail(ErrorKind::config,
              "[service] realtime = true: SCHED_FIFO at {}: {}; install "
              "/usr/share/waymark-locd/realtime.conf as a drop-in of locd.service, or set "
              "realtime = false",
              priority, std::error_code(failed, std::generic_category()).message());
}

Status check_realtime() {
  Status permitted;
  std::thread([&] { permitted = make_realtime(kCapturePriority); }).join();
  return permitted;
}

Status lock_memory() {
  // On fault: the stacks of threads are far larger than what is used of them.
  if (::mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0) return {};
  return fail(ErrorKind::config,
              "[service] lock_memory = true: {}; the service needs LimitMEMLOCK=infinity, as "
              "locd.service has it, or set lock_memory = false",
              system_reason());
}

void keep_heap(std::size_t reserve_bytes) {
  ::mallopt(M_ARENA_MAX, 1);
  ::mallopt(M_MMAP_MAX, 0);
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  // Given back to the heap, not to the system; written, for pages come with the first write. By
  // explicit_bzero, for a compiler may leave out memory that nobody reads.
  void* const reserve = std::malloc(reserve_bytes);
  if (reserve == nullptr) return;  // what needs so much will say so
  ::explicit_bzero(reserve, reserve_bytes);
  std::free(reserve);
}

}  // namespace waymark
