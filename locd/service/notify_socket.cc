#include "locd/service/notify_socket.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <string_view>

namespace waymark {

NotifySocket::NotifySocket() {
  const char* const named = std::getenv("NOTIFY_SOCKET");
  const std::string_view name = named != nullptr ? named : "";
  const bool is_path = name.starts_with('/');
  if ((!is_path && !name.starts_with('@')) || name.size() >= sizeof address_.sun_path) return;
  address_.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), std::begin(address_.sun_path));
  // An abstract name begins with a zero and ends without one.
  if (!is_path) address_.sun_path[0] = '\0';
  address_size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size() +
                                         static_cast<std::size_t>(is_path));
  socket_ = Descriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
}

bool NotifySocket::send(const std::string& message, int flags) const {
  if (address_size_ == 0) return true;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how sockets take addresses
  const auto* const address = reinterpret_cast<const sockaddr*>(&address_);
  const ssize_t sent = ::sendto(socket_.get(), message.data(), message.size(), flags | MSG_NOSIGNAL,
                                address, address_size_);
  return sent >= 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
}

}  // namespace waymark
