#include "drivers/device_monitor.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/descriptor.h"

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(DeviceMonitor, HearsOfNothingWithoutWaiting) {
  auto monitor = DeviceMonitor::open();
  ASSERT_TRUE(monitor) << monitor.error().message;
  const auto came = monitor->device_came();
  ASSERT_TRUE(came) << came.error().message;
  EXPECT_FALSE(*came);
}

TEST(DeviceMonitor, OneThatFailsSaysSo) {
  auto monitor = DeviceMonitor::open();
  ASSERT_TRUE(monitor) << monitor.error().message;
  const Descriptor nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  ASSERT_EQ(::dup3(nothing.get(), monitor->descriptor(), O_CLOEXEC), monitor->descriptor());
  const auto came = monitor->device_came();
  ASSERT_FALSE(came);
  EXPECT_EQ(came.error().kind, ErrorKind::unavailable);
  EXPECT_THAT(came.error().message, HasSubstr("tried for every few seconds"));
}

}  // namespace
}  // namespace waymark
