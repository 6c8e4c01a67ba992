#include "drivers/v4l2/device_lookup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/drivers/v4l2/fake_video_system.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::HasSubstr;

const std::vector<VideoDevice> kDevices{
    {"/dev/video0", {"/dev/v4l/by-id/usb-left"}, "usb-0000:00:14.0-1", "left", "Grey"},
    {"/dev/video2", {"/dev/v4l/by-id/usb-twin"}, "usb-0000:00:14.0-2", "twin", "Grey"},
    {"/dev/video4", {"/dev/v4l/by-id/usb-twin"}, "usb-0000:00:14.0-3", "twin", "Grey"},
    {"/dev/video6", {"/dev/v4l/by-path/platform-vivid"}, "platform:vivid-000", "", "vivid"},
    {"/dev/video7", {}, "platform:vivid-000", "", "vivid"},
    {"/dev/video8", {}, "platform:vivid-000", "", "vivid"}};

TEST(DeviceIdentity, IsALinkASerialNumberOrABusNeverANumber) {
  EXPECT_EQ(parse_device_identity("/dev/v4l/by-id/usb-left")->path, "/dev/v4l/by-id/usb-left");
  EXPECT_EQ(parse_device_identity("serial=4711")->serial, "4711");
  const auto both = parse_device_identity("bus=usb-0000:00:14.0-1  serial=a=b");
  ASSERT_TRUE(both);
  EXPECT_EQ(both->bus, "usb-0000:00:14.0-1");
  EXPECT_EQ(both->serial, "a=b");
  EXPECT_EQ(both->text(), "bus=usb-0000:00:14.0-1 serial=a=b");
  for (const char* wrong : {"/dev/video0", "/dev/video", "0", "left", "", " ", "serial=", "=x",
                            "port=3", "serial=a b", "serial"}) {
    const auto identity = parse_device_identity(wrong);
    ASSERT_FALSE(identity) << wrong;
    EXPECT_EQ(identity.error().kind, ErrorKind::config);
    EXPECT_THAT(identity.error().message, HasSubstr("--list-cameras"));
  }
}

TEST(FindDevice, EachWayLeadsToTheDevice) {
  const auto node = [](const char* text) {
    const auto device = find_device(*parse_device_identity(text), kDevices);
    return device ? device->node : device.error().message;
  };
  EXPECT_EQ(node("/dev/v4l/by-id/usb-left"), "/dev/video0");
  EXPECT_EQ(node("serial=left"), "/dev/video0");
  EXPECT_EQ(node("bus=usb-0000:00:14.0-3"), "/dev/video4");
  EXPECT_EQ(node("bus=usb-0000:00:14.0-2 serial=twin"), "/dev/video2");
  EXPECT_EQ(node("/dev/v4l/by-path/platform-vivid"), "/dev/video6");
}

TEST(FindDevice, NoneIsUnavailableAndSaysHowToLook) {
  for (const char* text :
       {"serial=right", "bus=usb-9", "bus=usb-0000:00:14.0-2 serial=left", "/dev/v4l/by-id/none"}) {
    const auto device = find_device(*parse_device_identity(text), kDevices);
    ASSERT_FALSE(device) << text;
    EXPECT_EQ(device.error().kind, ErrorKind::unavailable);
    EXPECT_THAT(device.error().message, HasSubstr(text));
    EXPECT_THAT(device.error().message, HasSubstr("--list-cameras"));
  }
}

TEST(MayBe, RulesOutByLinkSerialNumberAndPortWhatNeedNotBeOpened) {
  const VideoDevice usb{"/dev/video0", {"/dev/v4l/by-id/usb-left"}, "usb-1", "left", ""};
  EXPECT_TRUE(may_be({}, usb));
  EXPECT_TRUE(may_be({"", "left", ""}, usb));
  EXPECT_TRUE(may_be({"", "", "usb-1"}, usb));
  EXPECT_TRUE(may_be({"", "left", "usb-1"}, usb));
  EXPECT_TRUE(may_be({"/dev/v4l/by-id/usb-left", "", ""}, usb));
  EXPECT_FALSE(may_be({"", "right", ""}, usb));
  EXPECT_FALSE(may_be({"", "right", "usb-1"}, usb));
  EXPECT_FALSE(may_be({"", "left", "usb-2"}, usb));
  EXPECT_FALSE(may_be({"", "", "usb-2"}, usb));
  EXPECT_FALSE(may_be({"", "", "platform:vivid-000"}, usb));
  EXPECT_FALSE(may_be({"/dev/v4l/by-id/usb-right", "", ""}, usb));
}

TEST(MayBe, OnlyTheOpenedDeviceTellsABusThatIsNotUsb) {
  const VideoDevice not_usb{"/dev/video0", {}, "", "", ""};
  EXPECT_TRUE(may_be({"", "", "platform:vivid-000"}, not_usb));
  EXPECT_FALSE(may_be({"", "", "usb-1"}, not_usb));
}

TEST(FindDevice, ATwinMakesAMissingCameraNoWrongConfiguration) {
  for (const char* text : {"serial=twin", "/dev/v4l/by-id/usb-twin", "bus=platform:vivid-000"}) {
    const auto device = find_device(*parse_device_identity(text), kDevices);
    ASSERT_FALSE(device) << text;
    EXPECT_EQ(device.error().kind, ErrorKind::unavailable) << "unplugging one mends it";
    EXPECT_THAT(device.error().message, HasSubstr("can't be told apart"));
    EXPECT_THAT(device.error().message, HasSubstr("unplug all but one"));
  }
}

/// What a device may say of itself, to be pasted into locd.toml or shown in a terminal.
const std::vector<std::string> kHostile{"X'\n[lcm]\nurl=\"udpm://239.1.1.1:7667?ttl=255\"\n#",
                                        "X\"",
                                        "X'",
                                        "X\x1b[2J",
                                        "X\r",
                                        std::string("X\0Y", 3),
                                        "X\x7f",
                                        "X\xc2\x9b"
                                        "2J",
                                        "X\xff",
                                        "Größe"};

TEST(IdentityAmong, WhatCantBePastedIsNoIdentity) {
  for (const std::string& name : kHostile) {
    const VideoDevice device{"/dev/video0", {"/dev/v4l/by-id/" + name}, "usb-1", name, name};
    EXPECT_EQ(identity_among(device, {device}), "bus=usb-1") << name;
    EXPECT_FALSE(parse_device_identity("serial=" + name)) << name;
    EXPECT_FALSE(parse_device_identity("/dev/v4l/by-id/" + name)) << name;
    VideoDevice nameless = device;
    nameless.bus = name;
    EXPECT_EQ(identity_among(nameless, {nameless}), "") << name;
    for (const char c : name_of(device)) EXPECT_TRUE(c < 0 || (c >= ' ' && c != 0x7f)) << name;
  }
}

/// A camera with its node of metadata, before or after udev lets our group open them.
std::vector<VideoDevice> nodes_of_one_camera(bool image_permitted, bool metadata_permitted) {
  std::vector<VideoDevice> nodes;
  const std::vector<std::string> links{"/dev/v4l/by-id/usb-left"};
  if (image_permitted) {
    nodes.push_back({"/dev/video0", links, "usb-1", "left", "Grey"});
  } else {
    nodes.push_back({"/dev/video0", links, "usb-1", "left", "", false});
  }
  // Once it can be opened it is seen to be no camera, and not listed.
  if (!metadata_permitted) nodes.push_back({"/dev/video1", {}, "usb-1", "left", "", false});
  return nodes;
}

TEST(FindDevice, ANodeThatMayNotBeOpenedIsNeitherASecondCameraNorAnAbsentOne) {
  for (const char* text :
       {"serial=left", "bus=usb-1", "bus=usb-1 serial=left", "/dev/v4l/by-id/usb-left"}) {
    const DeviceIdentity identity = *parse_device_identity(text);
    EXPECT_TRUE(find_device(identity, nodes_of_one_camera(true, true))) << text;
    const auto found = find_device(identity, nodes_of_one_camera(true, false));
    ASSERT_TRUE(found) << text << found.error().message;
    EXPECT_EQ(found->node, "/dev/video0");
    for (const bool metadata : {true, false}) {
      const auto refused = find_device(identity, nodes_of_one_camera(false, metadata));
      ASSERT_FALSE(refused) << text;
      EXPECT_EQ(refused.error().kind, ErrorKind::permission) << refused.error().message;
      EXPECT_THAT(refused.error().message, HasSubstr("/dev/video0"));
      EXPECT_THAT(refused.error().message, HasSubstr("group video"));
    }
  }
  const auto another = find_device({"", "right", ""}, nodes_of_one_camera(false, false));
  ASSERT_FALSE(another);
  EXPECT_EQ(another.error().kind, ErrorKind::unavailable);
}

TEST(FindCameras, AreNodesThatCaptureAndThoseThatMayNotBeOpened) {
  test::FakeVideoSystem system;
  system.cameras.push_back({});
  system.cameras[1].identity.node = "/dev/video1";  // the same USB device's metadata
  system.cameras[1].captures = false;
  auto found = find_cameras(system, {"", "4711", ""});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(name_of(found[0]), "/dev/video0 (Fake, usb-1, serial 4711)");
  EXPECT_TRUE(find_cameras(system, {"", "0815", ""}).empty());
  system.cannot_open = Error{ErrorKind::permission, "group video"};
  found = find_cameras(system, {"", "4711", ""});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_FALSE(found[0].permitted || found[1].permitted);
  EXPECT_EQ(name_of(found[1]), "/dev/video1");
  system.cannot_open = Error{ErrorKind::unavailable, "gone meanwhile"};
  EXPECT_TRUE(find_cameras(system).empty());
}

TEST(FindCameras, ADeviceInAnotherPortIsNotOpenedForItMayHang) {
  test::FakeVideoSystem system;
  system.cameras.push_back({});
  system.cameras[1].identity = {"/dev/video2", {}, "usb-2", "4712", "Fake"};
  const auto found = find_cameras(system, {"", "", "usb-2"});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(name_of(found[0]), "/dev/video2 (Fake, usb-2, serial 4712)");
  EXPECT_EQ(system.cameras[0].opens, 0);
}

TEST(FindDevice, LinksThatOthersMadeLeadThereToo) {
  TemporaryFolder folder;
  const std::string node = folder.write("node", "").string();
  std::filesystem::create_symlink(node, folder.path() / "left");
  const std::vector<VideoDevice> devices{{node, {}, "usb-1", "", ""}};
  EXPECT_TRUE(find_device({(folder.path() / "left").string(), "", ""}, devices));
  EXPECT_FALSE(find_device({(folder.path() / "right").string(), "", ""}, devices));
}

TEST(IdentityAmong, IsTheFirstThatTellsADeviceFromTheOthers) {
  EXPECT_EQ(identity_among(kDevices[0], kDevices), "serial=left");
  EXPECT_EQ(identity_among(kDevices[1], kDevices), "bus=usb-0000:00:14.0-2");
  EXPECT_EQ(identity_among(kDevices[3], kDevices), "/dev/v4l/by-path/platform-vivid");
  EXPECT_EQ(identity_among(kDevices[4], kDevices), "");
}

}  // namespace
}  // namespace waymark
