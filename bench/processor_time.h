#pragma once

#include <sys/resource.h>

namespace waymark::bench {

/// Processor time of this process so far (s), user and system, of all its threads.
inline double processor_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace waymark::bench
