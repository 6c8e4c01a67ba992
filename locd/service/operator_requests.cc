#include "locd/service/operator_requests.h"

#include <algorithm>
#include <utility>

#include "core/base/text_field.h"

namespace waymark {
namespace {

std::string line_for_people(const ControlReply& reply) {
  return reply ? "ok " + in_one_line(reply->text) : "error: " + reply.error().message;
}

std::string line_for_programs(const ControlReply& reply) {
  nlohmann::ordered_json line;
  line["ok"] = reply.has_value();
  if (reply) {
    line["text"] = in_one_line(reply->text);
    if (reply->more.is_object()) line.update(reply->more);
  } else {
    line["code"] = reply.error().exit_code();
    line["text"] = reply.error().message;
  }
  // What is no UTF-8 (a file's name) must not end the service.
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A text's first word, and what follows it.
std::pair<std::string_view, std::string_view> split(std::string_view text) {
  const auto end = std::min(text.find(' '), text.size());
  return {text.substr(0, end), trimmed(text.substr(end))};
}

}  // namespace

PendingReply at_once(ControlReply reply) {
  return [reply = std::move(reply)](Stamp /*now*/) { return reply; };
}

void OperatorRequests::add(std::string word, std::string argument, Act act) {
  requests_.push_back({std::move(word), std::move(argument), std::move(act)});
}

ControlSocket::Answer OperatorRequests::handle(std::string_view line, Stamp now) const {
  const auto [first, rest] = split(line);
  const bool for_programs = first == "json";
  return [pending = act_on(for_programs ? rest : line, now),
          for_programs](Stamp later) -> std::optional<std::string> {
    const auto reply = pending(later);
    if (!reply) return std::nullopt;
    return for_programs ? line_for_programs(*reply) : line_for_people(*reply);
  };
}

PendingReply OperatorRequests::act_on(std::string_view request, Stamp now) const {
  const auto [word, argument] = split(request);
  const auto known = std::find_if(requests_.begin(), requests_.end(),
                                  [&, w = word](const Request& r) { return r.word == w; });
  if (known == requests_.end()) {
    return at_once(fail(ErrorKind::usage, "{} is no request; there are {}",
                        word.empty() ? "an empty line" : word, list()));
  }
  if (argument.empty() ? known->argument == "ID" : known->argument.empty()) {
    return at_once(fail(ErrorKind::usage, "the request is {}{}{}", known->word,
                        known->argument.empty() ? "" : " ", known->argument));
  }
  return known->act(argument, now);
}

std::string OperatorRequests::list() const {
  std::string list;
  for (const Request& request : requests_) {
    list += fmt::format("{}{}{}{}", list.empty() ? "" : ", ", request.word,
                        request.argument.empty() ? "" : " ", request.argument);
  }
  return list;
}

}  // namespace waymark
