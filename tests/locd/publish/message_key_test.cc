#include "locd/publish/message_key.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::HasSubstr;

const std::string kDigits = "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f";

class MessageKeyTest : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path write(const std::string& text,
                                            std::filesystem::perms may = kOwnerAndGroup) const {
    const auto file = tmp_.write("pose.key", text);
    std::filesystem::permissions(file, may);
    return file;
  }
  [[nodiscard]] std::string error(const std::filesystem::path& file) const {
    const auto key = MessageKey::read(file);
    if (key) return "taken";
    EXPECT_EQ(key.error().kind, ErrorKind::config);
    return key.error().message;
  }
  static constexpr auto kOwnerAndGroup = std::filesystem::perms::owner_read |
                                         std::filesystem::perms::owner_write |
                                         std::filesystem::perms::group_read;
  TemporaryFolder tmp_;
};

std::string mac_of(const MessageKey& key, std::string_view channel,
                   const signed_pose_t& signed_pose) {
  signed_pose_t message = signed_pose;
  key.sign(channel, message);
  std::string text;
  for (const std::uint8_t byte : message.mac) text += fmt::format("{:02x}", byte);
  return text;
}

signed_pose_t message_of(std::int64_t seq, std::vector<std::uint8_t> pose) {
  signed_pose_t message{};
  message.seq = seq;
  message.size = static_cast<std::int32_t>(pose.size());
  message.pose = std::move(pose);
  return message;
}

// Python: hmac.new(bytes(range(32)), b"WAYMARK_SIGNED_POSE\0" + seq.to_bytes(8, "big") + pose,
// "sha256").digest()[:16].hex()
TEST_F(MessageKeyTest, AnotherImplementationFindsTheSameCode) {
  const auto key = MessageKey::read(write(kDigits + "\n"));
  ASSERT_TRUE(key) << key.error().message;
  EXPECT_EQ(mac_of(*key, "WAYMARK_SIGNED_POSE", message_of(0x0102030405060708, {'a', 'b', 'c'})),
            "c23d0624ab243e8b1283e93be9dbcfa0");
  EXPECT_EQ(mac_of(*key, "WAYMARK_SIGNED_POSE", message_of(-1, {})),
            "a4b43c8ba67fd5015ca5b6403aad3481");
}

TEST_F(MessageKeyTest, WhateverDiffersTheCodeDoes) {
  const MessageKey key = *MessageKey::read(write(kDigits));
  const signed_pose_t message = message_of(7, {1, 2, 3});
  const std::string code = mac_of(key, "A_SIGNED_POSE", message);
  EXPECT_NE(mac_of(key, "B_SIGNED_POSE", message), code);
  EXPECT_NE(mac_of(key, "A_SIGNED_POSE", message_of(8, {1, 2, 3})), code);
  EXPECT_NE(mac_of(key, "A_SIGNED_POSE", message_of(7, {1, 2, 4})), code);
  EXPECT_NE(mac_of(key, "A_SIGNED_POSE", message_of(7, {1, 2})), code);
  std::string other_digits = kDigits;
  other_digits.back() = 'e';
  const MessageKey other = *MessageKey::read(write(other_digits));
  EXPECT_NE(other, key);
  EXPECT_NE(mac_of(other, "A_SIGNED_POSE", message), code);
}

TEST_F(MessageKeyTest, OtherTextIsNoKeyAndIsNotRepeated) {
  for (const std::string& text :
       {std::string(), kDigits.substr(1), kDigits + "0", kDigits + " ", "x" + kDigits.substr(1),
        kDigits + "\n" + kDigits, " " + kDigits, std::string(64, '\0')}) {
    const std::string said = error(write(text));
    EXPECT_THAT(said, HasSubstr("openssl rand -hex 32")) << text;
    EXPECT_EQ(said.find("0405060708"), std::string::npos) << said;
  }
}

TEST_F(MessageKeyTest, AKeyThatOthersMayReadOrWriteIsRefused) {
  for (const auto may :
       {std::filesystem::perms::others_read, std::filesystem::perms::others_write}) {
    EXPECT_THAT(error(write(kDigits, kOwnerAndGroup | may)), HasSubstr("chmod o="));
  }
}

TEST_F(MessageKeyTest, AnAbsentFileIsNoInput) {
  const auto key = MessageKey::read(tmp_.path() / "none");
  ASSERT_FALSE(key);
  EXPECT_EQ(key.error().kind, ErrorKind::no_input);
}

}  // namespace
}  // namespace waymark
