#include "locd/service/service_log.h"

#include <fmt/format.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

#include "core/base/one_line.h"
#include "locd/service/standard_error.h"

namespace waymark {
namespace {

/// stderr, of one thread. What nobody takes is lost; how much that was is said with what is taken
/// next.
class PatientSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    if (lost_ > 0 && offer_line(fmt::format("warning: {} lines before this one were lost, for "
                                            "nobody read the log",
                                            lost_))) {
      lost_ = 0;
    }
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    const bool taken = lost_ == 0 && offer_line(fmt::to_string(line));
    if (!taken) ++lost_;
  }
  void flush_() override {}

 private:
  std::size_t lost_ = 0;
};

}  // namespace

ServiceLog::ServiceLog()
    : logger_(std::make_shared<spdlog::logger>("locd", std::make_shared<PatientSink>())) {
  // The journal stamps lines itself.
  const bool in_journal = std::getenv("JOURNAL_STREAM") != nullptr;
  logger_->set_formatter(std::make_unique<spdlog::pattern_formatter>(
      in_journal ? "%l: %v" : "%Y-%m-%d %H:%M:%S.%e %l: %v", spdlog::pattern_time_type::local,
      ""));  // offer_line ends lines
}

void ServiceLog::note(const std::string& text) { logger_->info("{}", in_one_line(text)); }

void ServiceLog::event(const std::string& what, const std::string& text, Stamp now) {
  if (limiter_.admit(what, now)) logger_->warn("{}", in_one_line(text));
}

void ServiceLog::summarize(Stamp now) {
  if (const auto line = limiter_.summary(now)) {
    logger_->warn("{}", in_one_line(*line, kMaxSummaryBytes));
  }
}

}  // namespace waymark
