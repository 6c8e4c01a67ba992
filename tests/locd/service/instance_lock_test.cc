#include "locd/service/instance_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

TEST(InstanceLock, TheSecondIsToldThePidOfTheFirst) {
  const TemporaryFolder tmp;
  const auto file = tmp.path() / "run" / "locd.pid";
  {
    const auto first = InstanceLock::take(file);
    ASSERT_TRUE(first) << first.error().message;
    const auto second = InstanceLock::take(file);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::unavailable);
    EXPECT_EQ(second.error().exit_code(), 69);
    EXPECT_THAT(second.error().message,
                testing::HasSubstr("pid " + std::to_string(::getpid()) + ";"));
  }
  EXPECT_TRUE(InstanceLock::take(file));
}

TEST(InstanceLock, AStalePidIsNoLock) {
  const TemporaryFolder tmp;
  const auto file = tmp.write("locd.pid", "1234567\n");
  const auto lock = InstanceLock::take(file);
  ASSERT_TRUE(lock);
  EXPECT_EQ(tmp.read("locd.pid"), std::to_string(::getpid()) + "\n");
}

TEST(InstanceLock, TheHolderIsKnownWhileItHolds) {
  const TemporaryFolder tmp;
  const auto file = tmp.path() / "locd.pid";
  EXPECT_EQ(InstanceLock::holder(file), std::nullopt);
  {
    const auto lock = InstanceLock::take(file);
    EXPECT_EQ(InstanceLock::holder(file), ::getpid());
  }
  EXPECT_EQ(InstanceLock::holder(file), std::nullopt);
}

TEST(InstanceLock, WhoAsksForTheHolderNeverKeepsOneFromStarting) {
  const TemporaryFolder tmp;
  const auto file = tmp.write("locd.pid", "");
  std::atomic<bool> done{false};
  std::thread asking([&] {
    while (!done) static_cast<void>(InstanceLock::holder(file));
  });
  int refused = 0;
  for (int i = 0; i < 5000; ++i) refused += InstanceLock::take(file) ? 0 : 1;
  done = true;
  asking.join();
  EXPECT_EQ(refused, 0);
}

TEST(InstanceLock, AnotherProcessHoldsItAndALockOfOursIsNoneOfItsOwn) {
  const TemporaryFolder tmp;
  const auto file = tmp.path() / "locd.pid";
  const auto lock = InstanceLock::take(file);
  ASSERT_TRUE(lock);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto second = InstanceLock::take(file);
    ::_exit(!second && InstanceLock::holder(file) == ::getppid() ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(InstanceLock, OnlyAFileOfItsOwnIsWritten) {
  const TemporaryFolder tmp;
  const auto other = tmp.write("other", "what was there before");
  const auto refused = [&](const std::filesystem::path& file, const char* why) {
    const auto lock = InstanceLock::take(file);
    ASSERT_FALSE(lock) << file;
    EXPECT_EQ(lock.error().kind, ErrorKind::cant_create);
    EXPECT_THAT(lock.error().message,
                testing::AllOf(testing::HasSubstr(file.string()), testing::HasSubstr(why)));
    EXPECT_EQ(tmp.read("other"), "what was there before");
  };
  std::filesystem::create_symlink(other, tmp.path() / "link");
  refused(tmp.path() / "link", "a link");
  std::filesystem::create_symlink(tmp.path() / "absent", tmp.path() / "dangling");
  refused(tmp.path() / "dangling", "a link");
  EXPECT_FALSE(std::filesystem::exists(tmp.path() / "absent"));
  std::filesystem::create_hard_link(other, tmp.path() / "second");
  refused(tmp.path() / "second", "2 names");
  ASSERT_EQ(::mkfifo((tmp.path() / "pipe").c_str(), 0600), 0);
  refused(tmp.path() / "pipe", "no regular file");
}

TEST(InstanceLock, ALinkHasNoHolder) {
  const TemporaryFolder tmp;
  const auto file = tmp.path() / "locd.pid";
  const auto lock = InstanceLock::take(file);
  ASSERT_TRUE(lock);
  std::filesystem::create_symlink(file, tmp.path() / "link");
  EXPECT_EQ(InstanceLock::holder(tmp.path() / "link"), std::nullopt);
  EXPECT_EQ(InstanceLock::holder(file), ::getpid());
}

TEST(InstanceLock, APlaceThatCannotBeMadeIsSaid) {
  const auto lock = InstanceLock::take("/proc/locd/locd.pid");
  ASSERT_FALSE(lock);
  EXPECT_THAT(lock.error().message, testing::HasSubstr("/proc/locd/locd.pid"));
}

}  // namespace
}  // namespace waymark
