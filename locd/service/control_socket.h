#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/descriptor.h"
#include "core/base/error.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// A unix socket on which this machine's operators make requests: one line in, one line out. Who
/// may is said by the socket's mode, 0660, and its group. Never waits for a client.
class ControlSocket {
 public:
  /// An answer without its line end; nullopt: not yet, ask again.
  using Answer = std::function<std::optional<std::string>(Stamp now)>;
  /// Takes a request, without its line end; gives what to ask for the answer.
  using Handler = std::function<Answer(std::string_view request)>;
  static constexpr std::size_t kMaxClients = 8;
  static constexpr std::size_t kMaxRequest = 256;  ///< bytes; who sends a longer line is cut off

  /// Listens at `path`, in place of what a dead process left there. Errors: cant_create,
  /// permission.
  [[nodiscard]] static Expected<ControlSocket> open(const std::filesystem::path& path);
  ControlSocket(ControlSocket&&) = default;
  ControlSocket& operator=(ControlSocket&&) = delete;
  /// Takes the socket's name away again.
  ~ControlSocket();

  /// Becomes readable when somebody connects.
  [[nodiscard]] int descriptor() const { return listener_.get(); }

  /// Handles the requests that have come and sends the answers that are ready. A client's next
  /// request is handled after the answer to the one before; a client that has closed its sending
  /// side still gets its answer.
  void serve(const Handler& handler, Stamp now);

 private:
  struct Client {
    Descriptor descriptor;
    std::string received;
    Answer answer;  ///< empty: nothing was asked
  };
  ControlSocket(Descriptor listener, std::filesystem::path path);
  void accept_clients();
  void turn_client_away();
  /// False when the client sends no more requests.
  static bool receive(Client& client);
  /// False when the client is done.
  static bool serve(Client& client, const Handler& handler, Stamp now);

  Descriptor listener_;
  /// Closed to accept and close a client when no other descriptor is left: a client that is never
  /// accepted would keep the listener readable.
  Descriptor spare_;
  std::filesystem::path path_;
  std::vector<Client> clients_;
};

}  // namespace waymark
