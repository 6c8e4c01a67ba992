#include "locd/service/service_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>

#include "core/base/descriptor.h"
#include "core/base/one_line.h"

namespace waymark {
namespace {

using testing::AllOf;
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

/// stderr as a stream of systemd's journal, which reads only when it is told to.
class ServiceLogOfAJournal : public testing::Test {
 protected:
  ServiceLogOfAJournal() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    journal_ = Descriptor(ends[0]);
    const Descriptor stream(ends[1]);
    stderr_before_ = Descriptor(::fcntl(2, F_DUPFD_CLOEXEC, 3));
    ::dup2(stream.get(), 2);
  }
  ~ServiceLogOfAJournal() override { ::dup2(stderr_before_.get(), 2); }

  /// All that was written so far.
  [[nodiscard]] std::string read() const {
    std::string text;
    std::array<char, 65536> part{};
    for (ssize_t size = 0;
         (size = ::recv(journal_.get(), part.data(), part.size(), MSG_DONTWAIT)) > 0;) {
      text.append(part.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

 private:
  Descriptor journal_;
  Descriptor stderr_before_;
};

TEST_F(ServiceLogOfAJournal, ThatStandsStillHoldsUpNothingAndHearsWhatItLost) {
  constexpr int kLines = 20'000;  // of 400 bytes: more than any socket takes
  ServiceLog log;
  for (int i = 0; i < kLines; ++i) log.note(fmt::format("{:05} {}", i, std::string(400, 'n')));
  const std::string taken = read();
  const auto lines = std::count(taken.begin(), taken.end(), '\n');
  EXPECT_GT(lines, 0);
  ASSERT_LT(lines, kLines);
  log.note("well again");
  EXPECT_THAT(read(),
              AllOf(HasSubstr(fmt::format("{} lines before this one were lost", kLines - lines)),
                    HasSubstr("well again\n")));
}

}  // namespace
}  // namespace waymark
