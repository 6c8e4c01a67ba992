#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/descriptor.h"
#include "core/base/error.h"

namespace waymark {

/// A unix socket on which this machine's operators make requests: one line in, one line out. Who
/// may is said by the socket's mode, 0660, and its group. Never waits for a client.
class ControlSocket {
 public:
  /// A request without its line end; the answer without one.
  using Answer = std::function<std::string(std::string_view request)>;
  static constexpr std::size_t kMaxClients = 8;
  static constexpr std::size_t kMaxRequest = 256;

  /// Listens at `path`, in place of what a dead process left there. Errors: cant_create,
  /// permission.
  [[nodiscard]] static Expected<ControlSocket> open(const std::filesystem::path& path);
  ControlSocket(ControlSocket&&) = default;
  ControlSocket& operator=(ControlSocket&&) = delete;
  /// Takes the socket's name away again.
  ~ControlSocket();

  /// Becomes readable when somebody connects.
  [[nodiscard]] int descriptor() const { return listener_.get(); }

  /// Answers whatever has come.
  void serve(const Answer& answer);

 private:
  struct Client {
    Descriptor descriptor;
    std::string received;
  };
  ControlSocket(Descriptor listener, std::filesystem::path path)
      : listener_(std::move(listener)), path_(std::move(path)) {}
  void accept_clients();
  /// False when the client is done.
  static bool serve(Client& client, const Answer& answer);

  Descriptor listener_;
  std::filesystem::path path_;
  std::vector<Client> clients_;
};

}  // namespace waymark
