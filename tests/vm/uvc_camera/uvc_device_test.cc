#include "tests/vm/uvc_camera/uvc_device.h"

#include <gtest/gtest.h>

#include "tests/vm/uvc_camera/usb_descriptors.h"

namespace waymark::uvc {
namespace {

FrameFeed one_frame() {
  FrameFeed feed;
  feed.format.width_px = 8;
  feed.format.height_px = 4;
  feed.format.fps = 10;
  feed.format.max_frame_bytes = 32;
  feed.format.serial = "WM-0";
  feed.images.emplace_back(32, std::uint8_t{7});
  return feed;
}

constexpr std::uint16_t kProbe = 0x0100;
constexpr std::uint16_t kCommit = 0x0200;

TEST(UvcDevice, DescriptorsAreCutToWhatTheHostTakes) {
  UvcDevice device(one_frame());
  EXPECT_EQ(device.answer({0x80, 6, 0x0100, 0, 18, {}}, {}), device_descriptor());
  EXPECT_EQ(device.answer({0x80, 6, 0x0200, 0, 9, {}}, {})->size(), 9U);
  EXPECT_EQ(device.answer({0x80, 6, 0x0600, 0, 10, {}}, {}), std::nullopt);  // not two-speed
}

TEST(UvcDevice, ProbeSaysWhatCommitStarts) {
  UvcDevice device(one_frame());
  const auto probed = device.answer({0xA1, kGetCurrent, kProbe, kStreamInterface, 26, {}}, {});
  ASSERT_TRUE(probed);
  ASSERT_EQ(probed->size(), 26U);
  EXPECT_EQ((*probed)[18], 32);  // dwMaxVideoFrameSize
  EXPECT_EQ(device.answer({0x21, kSetCurrent, kProbe, kStreamInterface, 26, *probed}, {}), Bytes{});
  EXPECT_FALSE(device.stream().streaming());
  EXPECT_EQ(device.answer({0x21, kSetCurrent, kCommit, kStreamInterface, 26, *probed}, {}),
            Bytes{});
  EXPECT_TRUE(device.stream().streaming());
}

TEST(UvcDevice, ClearingTheEndpointEndsTheStream) {
  UvcDevice device(one_frame());
  ASSERT_TRUE(device.answer({0x21, kSetCurrent, kCommit, kStreamInterface, 26, Bytes(26)}, {}));
  EXPECT_EQ(device.answer({0x02, 1, 0, kStreamEndpoint, 0, {}}, {}), Bytes{});
  EXPECT_FALSE(device.stream().streaming());
}

TEST(UvcDevice, ObeysOrdersAndRefusesOthers) {
  UvcDevice device(one_frame());
  EXPECT_EQ(device.obey("mute"), "ok");
  EXPECT_TRUE(device.mute());
  EXPECT_EQ(device.obey("short 2"), "ok");
  EXPECT_EQ(device.obey("go"), "ok");
  EXPECT_FALSE(device.mute());
  EXPECT_TRUE(device.obey("short two").starts_with("error"));
  EXPECT_TRUE(device.obey("").starts_with("error"));
  EXPECT_NE(device.obey("status").find("\"gain\":16"), std::string::npos);
}

}  // namespace
}  // namespace waymark::uvc
