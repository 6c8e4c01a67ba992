#include "mapbuilder/import/ros_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/recordings.h"

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr Stamp kStamp{1'700'000'000'123'456'789};

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};  // NOLINT: bytes
}

TEST(RosMessages, AnImage) {
  const std::string message = test::raw_image("/a", kStamp, 3, 2, "mono8", 4, "abcdefgh").data;
  const auto image = parse_ros_image(bytes_of(message));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->stamp, kStamp);
  EXPECT_EQ(image->width_px, 3U);
  EXPECT_EQ(image->height_px, 2U);
  EXPECT_EQ(image->encoding, "mono8");
  EXPECT_EQ(image->step_bytes, 4U);
  EXPECT_EQ(image->data.size(), 8U);
  for (std::size_t size = 0; size < message.size(); ++size) {
    EXPECT_FALSE(parse_ros_image(bytes_of(message).first(size))) << size;
  }
}

TEST(RosMessages, ACompressedImage) {
  const std::string message = test::compressed_image("/a", kStamp, "jpeg", "file").data;
  const auto image = parse_ros_compressed_image(bytes_of(message));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->stamp, kStamp);
  EXPECT_EQ(image->format, "jpeg");
  EXPECT_EQ(image->data.size(), 4U);
}

TEST(RosMessages, ACameraInfo) {
  const std::string message = test::camera_info("/a", 640, 480, 500).data;
  const auto info = parse_ros_camera_info(bytes_of(message));
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->width_px, 640U);
  EXPECT_EQ(info->distortion_model, "plumb_bob");
  EXPECT_EQ(info->distortion.size(), 5U);
  EXPECT_EQ(info->camera_matrix[0], 500);
  EXPECT_EQ(info->camera_matrix[5], 239.5);
  EXPECT_EQ(info->projection_matrix[5], 1000);
  EXPECT_FALSE(info->binned);
  EXPECT_TRUE(
      parse_ros_camera_info(bytes_of(test::camera_info("/a", 640, 480, 500, 2).data))->binned);
  EXPECT_FALSE(parse_ros_camera_info(bytes_of(message).first(message.size() - 1)));
}

TEST(RosMessages, CoefficientsAreCounted) {
  const auto with = [](std::uint32_t count) {
    test::Cdr cdr;
    cdr.header(kStamp).number(std::uint32_t{4}).number(std::uint32_t{4}).text("plumb_bob");
    cdr.number(count);
    for (std::uint32_t i = 0; i < count + 30; ++i) cdr.number(0.0);
    return parse_ros_camera_info(bytes_of(cdr.bytes(std::string(32, '\0')).str()));
  };
  EXPECT_TRUE(with(16));
  EXPECT_THAT(with(17).error().message, HasSubstr("17 coefficients"));
}

TEST(RosMessages, StampsAndEncodingsThatAreNone) {
  std::string message = test::raw_image("/a", kStamp, 1, 1, "mono8", 1, "a").data;
  EXPECT_THAT(parse_ros_image(bytes_of("text that is none")).error().message, HasSubstr("CDR"));
  message.replace(8, 4, "\x00\xCA\x9A\x3B", 4);  // 10⁹ ns
  EXPECT_THAT(parse_ros_image(bytes_of(message)).error().message, HasSubstr("header.stamp"));
}

}  // namespace
}  // namespace waymark
