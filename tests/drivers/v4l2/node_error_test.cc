#include "drivers/v4l2/node_error.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "tests/drivers/v4l2/fake_video_system.h"

namespace waymark {
namespace {

TEST(NodeError, SaysWhatHelps) {
  test::FakeDevice device;
  device.identity.node = "/dev/video3";
  const test::FakeVideoNode node(device);
  const auto said = [&](int number) {
    const Error error = node_error(node, "can't start", number);
    EXPECT_TRUE(error.message.starts_with("/dev/video3: can't start: ")) << error.message;
    return std::pair(error.kind, error.message);
  };
  const auto expect = [&](int number, ErrorKind kind, const char* words) {
    const auto [is, message] = said(number);
    EXPECT_EQ(is, kind) << number;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  expect(ENODEV, ErrorKind::unavailable, "plug it in again");
  expect(ENXIO, ErrorKind::unavailable, "plug it in again");
  expect(ENOSPC, ErrorKind::unavailable, "USB bandwidth");
  expect(EACCES, ErrorKind::permission, "group video");
  expect(EPERM, ErrorKind::permission, "group video");
  expect(EIO, ErrorKind::io, "Input/output error");
  expect(EBUSY, ErrorKind::unavailable, "fuser -v /dev/video3");
}

TEST(NodeError, NamesWhoHoldsABusyDevice) {
  test::FakeDevice device;
  device.identity.node = "/dev/video3";
  const test::FakeVideoNode node(device);
  device.holders = {{::getpid(), "locd"}, {4711, "guvcview"}};
  EXPECT_EQ(node_error(node, "can't start", EBUSY).message,
            "/dev/video3: can't start: guvcview (pid 4711) uses it; end that first");
  device.holders = {{::getpid(), "locd"}};
  EXPECT_NE(node_error(node, "can't start", EBUSY).message.find("two [[camera]] blocks"),
            std::string::npos);
}

TEST(SaysAbsent, OnlyWhereTheDeviceHasNoSuchThing) {
  for (const int number : {EINVAL, ENOTTY, ENODATA}) EXPECT_TRUE(says_absent(number)) << number;
  for (const int number : {0, EIO, EBUSY, ENODEV, ETIMEDOUT, EACCES}) {
    EXPECT_FALSE(says_absent(number)) << number;
  }
}

}  // namespace
}  // namespace waymark
