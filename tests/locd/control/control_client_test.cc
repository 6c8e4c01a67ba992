#include "locd/control/control_client.h"

#include <gmock/gmock.h>

#include "core/base/no_answer.h"
#include "tests/locd/control/fake_locd.h"
#include "tests/support/as_nobody.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::FakeLocd;
using testing::HasSubstr;

TEST(ControlClient, GivesTheMembersOfTheAnswer) {
  const FakeLocd locd("{\"ok\":true,\"text\":\"/a\",\"folder\":\"/a\"}\n");
  const auto answer = ask_locd(locd.path(), "start round 1", seconds(20));
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, nlohmann::ordered_json({{"text", "/a"}, {"folder", "/a"}}));
  EXPECT_EQ(locd.asked(), "json start round 1\n");
}

TEST(ControlClient, WhatLocdRefusesIsItsErrorAndCode) {
  for (const int code : {64, 65, 66, 69, 73, 74, 75, 77, 78}) {
    const FakeLocd locd("{\"ok\":false,\"code\":" + std::to_string(code) +
                        ",\"text\":\"marker 12 is not in quarantine\"}\n");
    const auto answer = ask_locd(locd.path(), "release 12", seconds(20));
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().exit_code(), code);
    EXPECT_EQ(answer.error().message, "marker 12 is not in quarantine");
  }
}

TEST(ControlClient, WhatIsNoAnswerOfLocdsIsBadData) {
  for (const char* line :
       {"ok not recording\n", "\n", "{}\n", "[1]\n", "{\"ok\":1,\"text\":\"\"}\n",
        "{\"ok\":true}\n", "{\"ok\":false,\"text\":\"\"}\n", "{\"ok\":true,\"text\":7}\n"}) {
    const FakeLocd locd(line);
    EXPECT_EQ(ask_locd(locd.path(), "status", seconds(20)).error().kind, ErrorKind::bad_data)
        << line;
  }
  const FakeLocd endless(std::string(std::size_t{3} << 20, 'x'));
  EXPECT_EQ(ask_locd(endless.path(), "status", seconds(20)).error().kind, ErrorKind::bad_data);
  const FakeLocd confused("{\"ok\":false,\"code\":0,\"text\":\"\"}\n");
  EXPECT_EQ(ask_locd(confused.path(), "status", seconds(20)).error().kind, ErrorKind::internal);
}

TEST(ControlClient, WithoutLocdItIsUnavailable) {
  const TemporaryFolder folder;
  EXPECT_EQ(ask_locd(folder.path() / "control", "status", seconds(1)).error().kind,
            ErrorKind::unavailable);
  folder.write("control", "no socket");
  EXPECT_EQ(ask_locd(folder.path() / "control", "status", seconds(1)).error().kind,
            ErrorKind::unavailable);
  const FakeLocd ends("{\"ok\":true");
  EXPECT_EQ(ask_locd(ends.path(), "status", seconds(20)).error().kind, ErrorKind::unavailable);
}

TEST(ControlClient, WhoIsNotOfTheGroupIsToldSo) {
  const FakeLocd locd("{\"ok\":true,\"text\":\"\"}\n");
  std::filesystem::permissions(locd.path(), std::filesystem::perms::owner_all);
  std::filesystem::permissions(locd.path().parent_path(), std::filesystem::perms::all);
  const test::AsNobody nobody;
  if (!nobody.applies() || ::geteuid() != 65534) GTEST_SKIP() << "not the superuser";
  const auto answer = ask_locd(locd.path(), "status", seconds(20));
  EXPECT_EQ(answer.error().kind, ErrorKind::permission);
  EXPECT_THAT(answer.error().message, HasSubstr("group locd"));
}

TEST(ControlClient, ALocdThatIsSilentIsNotWaitedForWithoutEnd) {
  const FakeLocd silent("");
  const auto answer = ask_locd(silent.path(), "status", milliseconds(20));
  EXPECT_EQ(answer.error().kind, kNoAnswer);
  EXPECT_EQ(answer.error().exit_code(), 75);
}

TEST(ControlClient, ARequestIsOneLineToAPathThatCanBe) {
  EXPECT_EQ(ask_locd("/nowhere", "mark a\nstop", seconds(1)).error().kind, ErrorKind::usage);
  EXPECT_EQ(ask_locd(std::string(200, 'x'), "status", seconds(1)).error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace waymark
