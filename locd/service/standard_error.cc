#include "locd/service/standard_error.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>

namespace waymark {

bool offer_line(std::string line, int descriptor) {
  line.resize(std::min(line.size(), kMaxOfferedBytes - 1));
  line += '\n';
  // A pipe or socket that is ready takes so much at once, though it may wait with more.
  pollfd ready{descriptor, POLLOUT, 0};
  if (::poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) return false;
  return ::write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

}  // namespace waymark
