#include "locd/service/service_log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

#include "core/base/one_line.h"

namespace waymark {

ServiceLog::ServiceLog()
    : logger_(std::make_shared<spdlog::logger>("locd",
                                               std::make_shared<spdlog::sinks::stderr_sink_mt>())) {
  // The journal stamps lines itself.
  const bool in_journal = std::getenv("JOURNAL_STREAM") != nullptr;
  logger_->set_pattern(in_journal ? "%l: %v" : "%Y-%m-%d %H:%M:%S.%e %l: %v");
  logger_->flush_on(spdlog::level::info);
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
