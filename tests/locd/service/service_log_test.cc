#include "locd/service/service_log.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "core/base/one_line.h"

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::internal::CaptureStderr;
using testing::internal::GetCapturedStderr;

TEST(ServiceLog, ATextIsOneShortLineWhateverItQuotes) {
  CaptureStderr();
  ServiceLog log;
  const std::string hostile = "cam0: key\n<0>locd: rig on fire\x1b[2J" + std::string(10'000, 'k');
  log.note(hostile);
  log.event("KEY", hostile, Stamp{0});
  log.event(hostile, hostile, Stamp{0});
  log.event(hostile, hostile, Stamp{1});
  log.summarize(std::chrono::minutes(2));
  const std::string lines = GetCapturedStderr();
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 4);
  EXPECT_THAT(lines, HasSubstr("key\\n<0>locd: rig on fire\\x1b[2Jkkk"));
  EXPECT_EQ(lines.find('\x1b'), std::string::npos);
  EXPECT_LT(lines.size(), 3 * (kMaxLineBytes + 100) + ServiceLog::kMaxSummaryBytes + 100);
}

}  // namespace
}  // namespace waymark
