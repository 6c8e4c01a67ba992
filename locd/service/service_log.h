#pragma once

#include <memory>
#include <string>

#include "locd/service/log_limiter.h"

namespace spdlog {
class logger;
}

namespace waymark {

/// The service's log on stderr, where systemd's journal takes it: notes once, events limited. Each
/// text is a line by the rule of in_one_line, whatever it quotes. Nothing waits for who reads it:
/// lines that nobody takes are lost and counted. One thread.
class ServiceLog {
 public:
  /// A summary is a list of such texts.
  static constexpr std::size_t kMaxSummaryBytes = 4000;

  ServiceLog();

  /// A line that is never held back: start, reload, end.
  void note(const std::string& text);
  /// A line for the first time of `what`, a part of a summary for the following ones.
  void event(const std::string& what, const std::string& text, Stamp now);
  /// Writes the minute's summary, when it is due.
  void summarize(Stamp now);

 private:
  LogLimiter limiter_;
  std::shared_ptr<spdlog::logger> logger_;
};

}  // namespace waymark
