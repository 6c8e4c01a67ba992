#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/base/check.h"
#include "locd/service/control_socket.h"
#include "tests/fuzz/format.h"
#include "tests/support/temporary_folder.h"

namespace waymark::test {
namespace {

constexpr std::size_t kPiece = 100;  ///< bytes that a client sends at a time

/// The requests are known words; each is one line, as the socket has it.
ControlSocket::Answer answer(std::string_view request) {
  WAYMARK_CHECK(request.size() <= ControlSocket::kMaxRequest);
  WAYMARK_CHECK(request.find('\n') == std::string_view::npos);
  const bool known = request == "start" || request == "stop" || request == "status";
  return [known](Stamp /*now*/) { return known ? "ok" : "error: unknown"; };
}

Descriptor connect_to(const std::filesystem::path& path) {
  Descriptor client(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how sockets take addresses
  const auto* const name = reinterpret_cast<const sockaddr*>(&address);
  WAYMARK_CHECK(::connect(client.get(), name, sizeof address) == 0);
  return client;
}

/// A client that says all that and no more: taken when every line is answered with "ok".
Expected<std::size_t> say(std::string_view text) {
  static const TemporaryFolder folder;
  static auto socket = ControlSocket::open(folder.path() / "control").value();
  const Descriptor client = connect_to(folder.path() / "control");
  std::string answers;
  const auto turn = [&] {
    socket.serve(answer, Stamp(0));
    std::array<char, 4096> buffer{};
    const ssize_t got = ::recv(client.get(), buffer.data(), buffer.size(), 0);
    if (got > 0) answers.append(buffer.data(), static_cast<std::size_t>(got));
    return got != 0;
  };
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  for (; !text.empty(); text.remove_prefix(std::min(kPiece, text.size()))) {
    const std::string_view piece = text.substr(0, kPiece);
    if (::send(client.get(), piece.data(), piece.size(), MSG_NOSIGNAL) < 0 || !turn()) break;
  }
  ::shutdown(client.get(), SHUT_WR);
  (void)turn();
  const auto answered = static_cast<std::size_t>(std::count(answers.begin(), answers.end(), '\n'));
  WAYMARK_CHECK(answered <= lines);
  if (answered < lines) return fail(ErrorKind::usage, "control: a line of too many bytes");
  if (answers.find("error") != std::string::npos) {
    return fail(ErrorKind::usage, "control: an unknown request");
  }
  return answered;
}

const AddFormat control_request({"ControlRequest",
                                 {"start\n", "status\r\nstop\nstatus\n", "  stop \t\nstatus\n"},
                                 {"start", "stop", "status", "\n", "\r\n"},
                                 reader(say)});

}  // namespace
}  // namespace waymark::test
