#include "mapbuilder/import/bag_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/capture/jpeg.h"
#include "core/capture/pgm.h"
#include "tests/support/recordings.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_pattern.h"

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr Stamp kStart = std::chrono::seconds(1'700'000'000);

class BagImagesTest : public testing::Test {
 protected:
  Status take(const test::RecordedMessage& recorded, const std::string& encoding = "cdr") {
    const BagTopic topic{recorded.topic, recorded.type, encoding};
    return images_.take({&topic,
                         {reinterpret_cast<const std::uint8_t*>(recorded.data.data()),  // NOLINT
                          recorded.data.size()}});
  }

  const TemporaryFolder folder_;
  const GrayImage pattern_ = test_pattern(37, 23);
  BagImages images_{folder_.path(), {}, 2};
};

TEST_F(BagImagesTest, AreNamedByTheirStamps) {
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(take(test::raw_image("/l", kStart + Stamp(i), pattern_)));
  ASSERT_EQ(images_.topics().size(), 1U);
  const TopicImages& of = images_.topics().at("/l");
  EXPECT_EQ(of.seen, 5U);
  EXPECT_EQ(of.written, 3U) << "one of two, the first always";
  EXPECT_EQ(of.form, "mono8");
  EXPECT_EQ(of.earliest, kStart);
  EXPECT_EQ(folder_.read("topic0/1700000000000000002.pgm"), encode_pgm(pattern_.view()));
}

TEST_F(BagImagesTest, CompressedOnesAreKeptToTheByte) {
  const std::string file = encode_jpeg(pattern_.view(), 80).value();
  ASSERT_TRUE(take(test::compressed_image("/l", kStart, "jpeg", file)));
  EXPECT_EQ(folder_.read("topic0/1700000000000000000.jpg"), file);
}

TEST_F(BagImagesTest, AGlitchIsLeftOutAndCounted) {
  ASSERT_TRUE(take(test::compressed_image("/l", kStart, "jpeg", "no image")));
  ASSERT_TRUE(take(test::raw_image("/m", kStart, pattern_)));
  ASSERT_TRUE(take(test::raw_image("/m", kStart, pattern_)));  // the second of two
  ASSERT_TRUE(take(test::raw_image("/m", kStart, pattern_)));  // as the first
  EXPECT_EQ(images_.topics().at("/l").unreadable, 1U);
  EXPECT_EQ(images_.topics().at("/m").same_stamp, 1U);
  EXPECT_EQ(images_.written(), 1U);
}

TEST_F(BagImagesTest, WhatCanNotBeMeantIsRefused) {
  EXPECT_THAT(take(test::raw_image("/l", Stamp(0), pattern_)).error().message,
              HasSubstr("header.stamp is 0"));
  EXPECT_THAT(take(test::raw_image("/m", kStart, pattern_), "json").error().message,
              HasSubstr("\"json\""));
  test::RecordedMessage cut = test::raw_image("/n", kStart, pattern_);
  cut.data.resize(cut.data.size() - 1);
  EXPECT_THAT(take(cut).error().message, HasSubstr("/n: a message that ends"));
  ASSERT_TRUE(take(test::raw_image("/o", kStart, pattern_)));
  ASSERT_TRUE(take(test::raw_image("/o", kStart, pattern_)));
  EXPECT_THAT(take(test::raw_image("/o", kStart, test_pattern(36, 23))).error().message,
              HasSubstr("images of 37×23 and of 36×23"));
}

TEST_F(BagImagesTest, TopicsOfImagesAreCounted) {
  for (int i = 0; i < 64; ++i) {
    ASSERT_TRUE(take(test::raw_image("/" + std::to_string(i), kStart, pattern_)));
  }
  EXPECT_THAT(take(test::raw_image("/more", kStart, pattern_)).error().message,
              HasSubstr("more than 64 topics"));
}

TEST_F(BagImagesTest, KeepTheFirstCameraInfo) {
  ASSERT_TRUE(take(test::camera_info("/camera_info", 37, 23, 50)));
  ASSERT_TRUE(take(test::camera_info("/camera_info", 37, 23, 60)));
  EXPECT_EQ(images_.camera_infos().at("/camera_info").camera_matrix[0], 50);
}

TEST_F(BagImagesTest, WantImagesAndTellTheRest) {
  EXPECT_TRUE(images_.wants({"/l", "sensor_msgs/msg/Image", "cdr"}));
  EXPECT_TRUE(images_.wants({"/l/camera_info", "sensor_msgs/msg/CameraInfo", "cdr"}));
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(images_.wants({"/tf" + std::to_string(i / 2), "tf2_msgs/msg/TFMessage", "cdr"}));
  }
  EXPECT_EQ(images_.others().size(), 8U);
  EXPECT_EQ(images_.others()[1], "/tf1 (tf2_msgs/msg/TFMessage)");
  BagImages one({}, {"/r"}, 1);
  EXPECT_FALSE(one.wants({"/l", "sensor_msgs/msg/Image", "cdr"}));
  EXPECT_TRUE(one.wants({"/r", "sensor_msgs/msg/CompressedImage", "cdr"}));
}

}  // namespace
}  // namespace waymark
