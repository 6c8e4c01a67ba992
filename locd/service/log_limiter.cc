#include "locd/service/log_limiter.h"

#include <fmt/format.h>

namespace waymark {

bool LogLimiter::admit(const std::string& what, Stamp now) {
  if (now - hour_began_ >= std::chrono::hours(1)) {
    hour_began_ = now;
    first_in_hour_ = 0;
  }
  if (!subjects_.contains(what)) {
    std::erase_if(subjects_, [&](const auto& entry) {
      return entry.second.counted == 0 && now - entry.second.last >= kForget;
    });
  }
  const auto [found, is_new] = subjects_.try_emplace(what);
  Subject& subject = found->second;
  const bool news = is_new || now - subject.last >= kForget;
  subject.last = now;
  if (news && first_in_hour_ < kMaxFirst) {
    ++first_in_hour_;
    return true;
  }
  ++subject.counted;
  if (!summary_due_) summary_due_ = now + kSummaryPeriod;
  return false;
}

std::optional<std::string> LogLimiter::summary(Stamp now) {
  if (!summary_due_ || now < *summary_due_) return std::nullopt;
  summary_due_.reset();
  std::string line = "again within a minute:";
  const char* separator = " ";
  for (auto entry = subjects_.begin(); entry != subjects_.end();) {
    Subject& subject = entry->second;
    if (subject.counted > 0) {
      line += fmt::format("{}{} ({} times)", separator, entry->first, subject.counted);
      separator = ", ";
      subject.counted = 0;
    }
    entry = now - subject.last >= kForget ? subjects_.erase(entry) : std::next(entry);
  }
  return line;
}

}  // namespace waymark
