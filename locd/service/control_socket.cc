#include "locd/service/control_socket.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/base/system_call.h"
#include "core/base/text_field.h"

namespace waymark {
namespace {

/// The group "locd" may make requests, where there is one and this process may say so.
void give_to_group(const std::filesystem::path& path) {
  const ::group* const locd = ::getgrnam("locd");
  if (locd != nullptr && ::chown(path.c_str(), static_cast<uid_t>(-1), locd->gr_gid) != 0) {
    errno = 0;  // not the owner of that group: the socket stays with the process's own
  }
}

Descriptor open_spare() { return Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC)); }

}  // namespace

ControlSocket::ControlSocket(Descriptor listener, std::filesystem::path path)
    : listener_(std::move(listener)), spare_(open_spare()), path_(std::move(path)) {}

Expected<ControlSocket> ControlSocket::open(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.size() >= sizeof address.sun_path) {
    return fail(ErrorKind::cant_create, "{}: can't listen: a socket's path has at most {} bytes",
                name, sizeof address.sun_path - 1);
  }
  std::memcpy(address.sun_path, name.c_str(), name.size() + 1);
  ControlSocket socket(Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)),
                       path);
  const int listener = socket.descriptor();
  ::unlink(name.c_str());  // the lock is ours: whoever made it is gone
  // Nobody else may connect between bind and chmod.
  const mode_t mask = ::umask(0117);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how sockets take addresses
  const int bound = ::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  ::umask(mask);
  if (listener < 0 || bound != 0 || ::listen(listener, 8) != 0) {
    return fail(creation_error(), "{}: can't listen: {}", name, system_reason());
  }
  give_to_group(path);
  return socket;
}

ControlSocket::~ControlSocket() {
  if (listener_.valid()) ::unlink(path_.c_str());
}

void ControlSocket::accept_clients() {
  for (;;) {
    Descriptor client(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!client.valid()) {
      if (errno != EMFILE && errno != ENFILE) return;
      turn_client_away();
      return;
    }
    if (clients_.size() == kMaxClients) clients_.erase(clients_.begin());  // it has had its time
    clients_.push_back({std::move(client), "", {}});
  }
}

void ControlSocket::turn_client_away() {
  spare_ = Descriptor();
  { const Descriptor turned_away(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC)); }
  spare_ = open_spare();
}

void ControlSocket::serve(const Handler& handler, Stamp now) {
  accept_clients();
  std::erase_if(clients_, [&](Client& client) { return !serve(client, handler, now); });
}

bool ControlSocket::receive(Client& client) {
  std::array<char, kMaxRequest> buffer{};
  while (client.received.size() <= kMaxRequest) {
    const ssize_t got = ::recv(client.descriptor.get(), buffer.data(), buffer.size(), 0);
    if (got < 0) return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    if (got == 0) return false;
    client.received.append(buffer.data(), static_cast<std::size_t>(got));
  }
  return true;
}

bool ControlSocket::serve(Client& client, const Handler& handler, Stamp now) {
  const bool says_more = receive(client);
  for (;;) {
    if (client.answer) {
      const auto answer = client.answer(now);
      if (!answer) return true;
      client.answer = nullptr;
      const std::string line = *answer + "\n";
      if (::send(client.descriptor.get(), line.data(), line.size(), MSG_NOSIGNAL) < 0) return false;
    }
    const auto end = client.received.find('\n');
    if (std::min(end, client.received.size()) > kMaxRequest) return false;
    if (end == std::string::npos) return says_more;
    client.answer = handler(trimmed(std::string_view(client.received).substr(0, end)));
    client.received.erase(0, end + 1);
  }
}

}  // namespace waymark
