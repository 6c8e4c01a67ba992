#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

#include "core/base/cause.h"
#include "core/base/one_line.h"

namespace waymark {

/// Why something from the outside world could not be used. The values are the sysexits codes with
/// which a program ends when the error reaches its main function.
enum class ErrorKind : int {
  usage = 64,        ///< the command line is wrong
  bad_data = 65,     ///< input was read and makes no sense
  no_input = 66,     ///< an input file is absent or can't be opened
  unavailable = 69,  ///< a service or device is absent
  internal = 70,     ///< a bug of ours, or of a library
  cant_create = 73,  ///< an output can't be created
  io = 74,           ///< reading or writing failed half-way
  permission = 77,   ///< not allowed
  config = 78,       ///< a configuration file is wrong
};

/// One clear line: what failed, on what, why, and what to do about it. Whatever it quotes, it is
/// one printable line of at most kMaxLineBytes, so that wherever it goes (terminal, journal,
/// systemd, a message on the network) nothing need be asked of it again.
struct Error {
  Error(ErrorKind why, std::string_view text, std::optional<Cause> of = std::nullopt)
      : kind(why), message(in_one_line(text)), cause(of) {}

  ErrorKind kind;
  std::string message;         ///< "subject: text"
  std::optional<Cause> cause;  ///< where it is one of those that findings have

  [[nodiscard]] int exit_code() const { return static_cast<int>(kind); }
};

/// What a program prints of the error with which it ends: "error [csv] room.csv: …" as a finding's
/// line, or "mapbuilder: room.csv: …" where there is no cause.
[[nodiscard]] std::string line_of(const Error& error, std::string_view program);

template <typename T>
using Expected = tl::expected<T, Error>;
using Status = tl::expected<void, Error>;

/// `return fail(ErrorKind::bad_data, "{}: row {}: …", path, row);`
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> fail(ErrorKind kind, fmt::format_string<Args...> format,
                                         Args&&... args) {
  return tl::make_unexpected(Error{kind, fmt::format(format, std::forward<Args>(args)...)});
}

/// The same where what is wrong is one of the known causes; always bad_data. The message begins
/// with its subject: `return fail(Cause::csv, "{}: every row stands twice", path);`
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> fail(Cause cause, fmt::format_string<Args...> format,
                                         Args&&... args) {
  Error error{ErrorKind::bad_data, fmt::format(format, std::forward<Args>(args)...)};
  error.cause = cause;
  return tl::make_unexpected(std::move(error));
}

}  // namespace waymark
