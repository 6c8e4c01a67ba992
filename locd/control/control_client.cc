#include "locd/control/control_client.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/base/descriptor.h"
#include "core/base/no_answer.h"
#include "core/base/system_call.h"

namespace waymark {
namespace {

using Clock = std::chrono::steady_clock;

/// More is no answer of locd's: the longest holds the camchain of sixteen cameras.
constexpr std::size_t kMostAnswer = std::size_t{1} << 20;

Expected<Descriptor> connect_to(const std::filesystem::path& path) {
  const std::string name = path.string();
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name.size() >= sizeof address.sun_path) {
    return fail(ErrorKind::usage, "{}: a socket's path has at most {} bytes", name,
                sizeof address.sun_path - 1);
  }
  std::memcpy(address.sun_path, name.c_str(), name.size() + 1);
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how sockets take addresses
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    return socket;
  }
  if (errno == EACCES || errno == EPERM) {
    return fail(ErrorKind::permission,
                "{}: not allowed: members of group locd may (adduser USER locd, then log in again)",
                name);
  }
  return fail(ErrorKind::unavailable, "{}: locd does not listen here: {}; systemctl status locd",
              name, system_reason());
}

tl::unexpected<Error> gone(const std::filesystem::path& path) {
  return fail(ErrorKind::unavailable,
              "{}: locd has closed the connection without an answer; try again", path.string());
}

/// The line that comes, without its end.
Expected<std::string> receive_line(const Descriptor& socket, const std::filesystem::path& path,
                                   Clock::time_point deadline) {
  std::string line;
  while (line.size() <= kMostAnswer) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd readable{socket.get(), POLLIN, 0};
    const int ready = left > 0 ? ::poll(&readable, 1, static_cast<int>(left)) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) {
      return fail(kNoAnswer, "{}: locd does not answer; what was asked for may still be done",
                  path.string());
    }
    std::array<char, 4096> buffer{};
    const ssize_t got = ::recv(socket.get(), buffer.data(), buffer.size(), 0);
    if (got <= 0) return gone(path);
    line.append(buffer.data(), static_cast<std::size_t>(got));
    if (const auto end = line.find('\n'); end != std::string::npos) return line.substr(0, end);
  }
  return fail(ErrorKind::bad_data, "{}: answers without end: this is no locd", path.string());
}

/// A refusal's code, as far as it is one that programs end with.
ErrorKind kind_of(int code) {
  for (const ErrorKind kind : {ErrorKind::usage, ErrorKind::bad_data, ErrorKind::no_input,
                               ErrorKind::unavailable, ErrorKind::cant_create, ErrorKind::io,
                               kNoAnswer, ErrorKind::permission, ErrorKind::config}) {
    if (static_cast<int>(kind) == code) return kind;
  }
  return ErrorKind::internal;
}

Expected<nlohmann::ordered_json> read_answer(const std::string& line,
                                             const std::filesystem::path& path) {
  auto answer = nlohmann::ordered_json::parse(line, nullptr, false);
  const auto has = [&](const char* key, bool (nlohmann::ordered_json::*is)() const noexcept) {
    return answer.contains(key) && (answer[key].*is)();
  };
  using Json = nlohmann::ordered_json;
  const bool whole = answer.is_object() && has("ok", &Json::is_boolean) &&
                     has("text", &Json::is_string) &&
                     (answer["ok"].get<bool>() || has("code", &Json::is_number_integer));
  if (!whole) {
    return fail(ErrorKind::bad_data, "{}: answers in a way that locdctl does not know: {}",
                path.string(), line);
  }
  if (!answer["ok"].get<bool>()) {
    return fail(kind_of(answer["code"].get<int>()), "{}", answer["text"].get<std::string>());
  }
  answer.erase("ok");
  return answer;
}

}  // namespace

std::filesystem::path default_control_socket() {
  const char* const named = std::getenv("RUNTIME_DIRECTORY");
  const std::string folders = named != nullptr ? named : "";
  const std::filesystem::path folder =
      folders.empty() ? std::string("/run/locd") : folders.substr(0, folders.find(':'));
  return folder / "control";
}

Expected<nlohmann::ordered_json> ask_locd(const std::filesystem::path& path,
                                          const std::string& request,
                                          std::chrono::milliseconds patience) {
  if (request.find('\n') != std::string::npos) {
    return fail(ErrorKind::usage, "a request is one line");
  }
  const auto deadline = Clock::now() + patience;
  auto socket = connect_to(path);
  if (!socket) return tl::make_unexpected(socket.error());
  const std::string line = "json " + request + "\n";
  if (::send(socket->get(), line.data(), line.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(line.size())) {
    return gone(path);
  }
  const auto answer = receive_line(*socket, path, deadline);
  if (!answer) return tl::make_unexpected(answer.error());
  return read_answer(*answer, path);
}

}  // namespace waymark
