// Holds one thread of a process by ptrace, as a thread that is stuck for ever, until ended.
// Usage: hold_thread TID (as in /proc/PID/task); says "held" when it does.
#include <fmt/format.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "core/base/system_call.h"

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  const auto thread = static_cast<pid_t>(std::strtol(argv[1], nullptr, 10));
  if (::ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0 ||
      ::ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) != 0 ||
      ::waitpid(thread, nullptr, __WALL) != thread) {
    fmt::print(stderr, "hold_thread: {}: {}\n", thread, waymark::system_reason());
    return 77;
  }
  fmt::print("held\n");
  std::fflush(stdout);
  // Its end, or the traced process's, is ours.
  ::waitpid(thread, nullptr, __WALL);
  return 0;
}
