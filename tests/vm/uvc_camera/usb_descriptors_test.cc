#include "tests/vm/uvc_camera/usb_descriptors.h"

#include <gtest/gtest.h>

namespace waymark::uvc {
namespace {

CameraFormat format_of(PixelFormat pixels) {
  CameraFormat format;
  format.width_px = 640;
  format.height_px = 512;
  format.fps = 10;
  format.pixels = pixels;
  format.max_frame_bytes = 640 * 512;
  format.serial = "WM-0";
  return format;
}

std::uint32_t number_at(const Bytes& bytes, std::size_t offset, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value |= static_cast<std::uint32_t>(bytes.at(offset + i)) << (8 * i);
  }
  return value;
}

/// Descriptors one after the other, each with its own length first.
std::vector<Bytes> parts_of(const Bytes& bytes) {
  std::vector<Bytes> parts;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t length = bytes[at];
    if (length == 0 || at + length > bytes.size()) {
      ADD_FAILURE() << "descriptor at " << at << " says that it has " << length << " bytes";
      break;
    }
    parts.emplace_back(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                       bytes.begin() + static_cast<std::ptrdiff_t>(at + length));
    at += length;
  }
  return parts;
}

/// The first one of class-specific kind `subtype` within interface `number`.
Bytes class_part(const Bytes& configuration, std::uint8_t interface, std::uint8_t subtype) {
  int within = -1;
  for (const Bytes& part : parts_of(configuration)) {
    if (part[1] == 4) within = part[2];
    if (within == interface && part[1] == 0x24 && part[2] == subtype) return part;
  }
  ADD_FAILURE() << "no descriptor " << int{subtype} << " in interface " << int{interface};
  return {};
}

TEST(UsbDescriptors, TheDeviceIsWhatItIs) {
  const Bytes device = device_descriptor();
  ASSERT_EQ(device.size(), 18U);
  EXPECT_EQ(device[0], 18);
  EXPECT_EQ(number_at(device, 2, 2), 0x0200U);
  EXPECT_EQ(number_at(device, 8, 2), kVendor);
  EXPECT_EQ(number_at(device, 10, 2), kProduct);
  EXPECT_EQ(device[16], 3);  // the serial number's string
}

TEST(UsbDescriptors, LengthsAddUp) {
  for (const PixelFormat pixels : {PixelFormat::grey, PixelFormat::mjpeg}) {
    const Bytes configuration = configuration_descriptor(format_of(pixels));
    EXPECT_EQ(number_at(configuration, 2, 2), configuration.size());
    // What the two interfaces' headers say of the class-specific descriptors that follow them.
    std::size_t class_bytes[2] = {0, 0};
    std::size_t within = 0;
    for (const Bytes& part : parts_of(configuration)) {
      if (part[1] == 4) within = part[2];
      if (part[1] == 0x24) class_bytes[within] += part.size();
    }
    EXPECT_EQ(number_at(class_part(configuration, 0, 1), 5, 2), class_bytes[0]);
    EXPECT_EQ(number_at(class_part(configuration, 1, 1), 4, 2), class_bytes[1]);
  }
}

TEST(UsbDescriptors, GreyIsY800WithItsSizeAndInterval) {
  const Bytes configuration = configuration_descriptor(format_of(PixelFormat::grey));
  const Bytes format = class_part(configuration, kStreamInterface, 4);
  EXPECT_EQ(std::string(format.begin() + 5, format.begin() + 9), "Y800");
  EXPECT_EQ(format[21], 8);  // bits per pixel
  const Bytes frame = class_part(configuration, kStreamInterface, 5);
  EXPECT_EQ(number_at(frame, 5, 2), 640U);
  EXPECT_EQ(number_at(frame, 7, 2), 512U);
  EXPECT_EQ(number_at(frame, 17, 4), 640U * 512U);
  EXPECT_EQ(number_at(frame, 21, 4), 1'000'000U);  // 100 ms in 100 ns
}

TEST(UsbDescriptors, StringsAreUtf16AndTheSerialIsTheCameras) {
  const auto serial = string_descriptor(3, format_of(PixelFormat::grey));
  EXPECT_EQ(serial, (Bytes{10, 3, 'W', 0, 'M', 0, '-', 0, '0', 0}));
  EXPECT_EQ(string_descriptor(0, format_of(PixelFormat::grey)), (Bytes{4, 3, 9, 4}));
  EXPECT_EQ(string_descriptor(9, format_of(PixelFormat::grey)), std::nullopt);
}

}  // namespace
}  // namespace waymark::uvc
