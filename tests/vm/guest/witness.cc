// Records, from above all else that runs in the guest, when a processor of the machine stood still
// and what locd did: what tells locd's own delays from the emulation's. JSON lines, times of
// CLOCK_MONOTONIC in seconds:
//   {"cpu", "from_s", "to_s"}: a processor that ran nothing, for more than kStall
//   {"at_s", "pid", "at_work", "ran_s", "waited_s", "in"}, each kSample: threads of locd that run
//   or wait for a processor; what its service thread ran and waited for one so far, and the
//   kernel's function in which that sleeps. pid 0: there is no locd, at_work are the threads of all
//   others.
// Usage: witness FILE
#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/base/descriptor.h"
#include "core/base/system_call.h"
#include "drivers/monotonic_clock.h"

namespace {

using namespace waymark;

constexpr Stamp kPulse = std::chrono::milliseconds(20);
constexpr Stamp kStall = std::chrono::milliseconds(50);
constexpr Stamp kSample = std::chrono::milliseconds(50);
constexpr const char* kProcesses = "/sys/fs/cgroup/system.slice/locd.service/cgroup.procs";

double seconds(Stamp stamp) { return std::chrono::duration<double>(stamp).count(); }

/// Lines of several threads. On a disk in memory: nothing is waited for.
class Notebook {
 public:
  explicit Notebook(const char* path) : file_(std::fopen(path, "we")) {}
  [[nodiscard]] bool good() const { return file_ != nullptr; }
  void write(const std::string& line) {
    const std::lock_guard lock(mutex_);
    std::fputs(line.c_str(), file_);
    std::fflush(file_);
  }

 private:
  std::mutex mutex_;
  std::FILE* file_;
};

/// The beginning of a file of /proc; empty: there is none.
std::string text_of(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, 512> text{};
  const ssize_t size = file.valid() ? ::read(file.get(), text.data(), text.size()) : 0;
  return {text.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

void become_first(int priority) {
  const sched_param parameters{priority};
  if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) {
    fmt::print(stderr, "witness: {}\n", system_reason());
    std::exit(77);
  }
}

void watch_processor(unsigned cpu, Notebook& notebook) {
  cpu_set_t own;
  CPU_ZERO(&own);
  CPU_SET(cpu, &own);
  ::sched_setaffinity(0, sizeof own, &own);
  become_first(99);
  for (Stamp last = monotonic_now();;) {
    std::this_thread::sleep_for(kPulse);
    const Stamp now = monotonic_now();
    if (now - last > kPulse + kStall) {
      notebook.write(fmt::format("{{\"cpu\": {}, \"from_s\": {:.3f}, \"to_s\": {:.3f}}}\n", cpu,
                                 seconds(last + kPulse), seconds(now)));
    }
    last = now;
  }
}

/// locd's, as "/proc/PID"; empty: it does not run.
std::string process_of_locd() {
  const std::string numbers = text_of(kProcesses);
  for (std::size_t begin = 0; begin < numbers.size();) {
    const std::size_t end = std::min(numbers.find('\n', begin), numbers.size());
    std::string process = "/proc/" + numbers.substr(begin, end - begin);
    if (text_of(process + "/comm") == "locd\n") return process;
    begin = end + 1;
  }
  return {};
}

int threads_at_work(const std::string& process) {
  DIR* const folder = ::opendir((process + "/task").c_str());
  if (folder == nullptr) return 0;
  int count = 0;
  while (const dirent* const entry = ::readdir(folder)) {
    if (entry->d_name[0] == '.') continue;
    const std::string stat = text_of(fmt::format("{}/task/{}/stat", process, entry->d_name));
    const std::size_t name_end = stat.rfind(')');
    count += name_end + 2 < stat.size() && stat[name_end + 2] == 'R' ? 1 : 0;
  }
  ::closedir(folder);
  return count;
}

/// Of the whole machine, this one left out.
int others_at_work() {
  int running = 0;
  std::sscanf(text_of("/proc/loadavg").c_str(), "%*s %*s %*s %d/", &running);
  return std::max(running - 1, 0);
}

std::string sample() {
  const std::string process = process_of_locd();
  const double now_s = seconds(monotonic_now());
  if (process.empty()) {
    return fmt::format("{{\"at_s\": {:.3f}, \"pid\": 0, \"at_work\": {}}}\n", now_s,
                       others_at_work());
  }
  unsigned long long ran_ns = 0;
  unsigned long long waited_ns = 0;
  const std::string main_thread = process + "/task/" + process.substr(6);
  std::sscanf(text_of(main_thread + "/schedstat").c_str(), "%llu %llu", &ran_ns, &waited_ns);
  return fmt::format(
      "{{\"at_s\": {:.3f}, \"pid\": {}, \"at_work\": {}, \"ran_s\": {:.3f}, \"waited_s\": {:.3f}, "
      "\"in\": \"{}\"}}\n",
      now_s, process.substr(6), threads_at_work(process), static_cast<double>(ran_ns) * 1e-9,
      static_cast<double>(waited_ns) * 1e-9, text_of(main_thread + "/wchan"));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  // Nothing of its own is waited for.
  ::mlockall(MCL_CURRENT | MCL_FUTURE);
  Notebook notebook(argv[1]);
  if (!notebook.good()) return 73;
  std::vector<std::thread> watches;
  for (unsigned cpu = 0; cpu < std::thread::hardware_concurrency(); ++cpu) {
    watches.emplace_back(watch_processor, cpu, std::ref(notebook));
  }
  become_first(98);
  for (;;) {
    notebook.write(sample());
    std::this_thread::sleep_for(kSample);
  }
}
