#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "locd/service/control_socket.h"

namespace waymark {

/// What a request is answered with.
struct ControlAnswer {
  std::string text;             ///< for people, one line
  nlohmann::ordered_json more;  ///< for programs: an object, of which `text` becomes a member
};
using ControlReply = Expected<ControlAnswer>;
/// nullopt: not yet, ask again.
using PendingReply = std::function<std::optional<ControlReply>(Stamp now)>;

/// A reply that is known already.
[[nodiscard]] PendingReply at_once(ControlReply reply);

/// The requests that operators make on the control socket, a line each: a word, and for some what
/// it is about. Answers: "ok TEXT" or "error: TEXT"; to "json REQUEST" instead one JSON object,
/// {"ok": true, "text": …} or {"ok": false, "code": sysexits, "text": …}.
class OperatorRequests {
 public:
  /// Does what is requested; takes what follows the word.
  using Act = std::function<PendingReply(std::string_view argument, Stamp now)>;

  /// `argument`: what follows the word, as the list of requests shows it: "" nothing, "[TEXT]"
  /// something or nothing, "ID" something.
  void add(std::string word, std::string argument, Act act);

  /// The answer to a line; whatever it holds, one line comes of it.
  [[nodiscard]] ControlSocket::Answer handle(std::string_view line, Stamp now) const;

 private:
  struct Request {
    std::string word;
    std::string argument;
    Act act;
  };
  [[nodiscard]] PendingReply act_on(std::string_view request, Stamp now) const;
  [[nodiscard]] std::string list() const;

  std::vector<Request> requests_;
};

}  // namespace waymark
