#include "locd/service/instance_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

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

TEST(InstanceLock, APlaceThatCannotBeMadeIsSaid) {
  const auto lock = InstanceLock::take("/proc/locd/locd.pid");
  ASSERT_FALSE(lock);
  EXPECT_THAT(lock.error().message, testing::HasSubstr("/proc/locd/locd.pid"));
}

}  // namespace
}  // namespace waymark
