#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <waymark/signed_pose_t.hpp>

#include "core/base/error.h"

namespace waymark {

/// A secret that locd and its listeners share, so that these know its poses from forged ones.
class MessageKey {
 public:
  static constexpr std::size_t kBytes = 32;

  /// 64 hexadecimal digits, as `openssl rand -hex 32` prints them, in a file that only its owner
  /// and its group may read. Errors: those of read_file; config for other text, for a file that
  /// others may read or write.
  [[nodiscard]] static Expected<MessageKey> read(const std::filesystem::path& file);

  /// Fills in the message's mac. Allocates nothing.
  void sign(std::string_view channel, signed_pose_t& message) const;

  bool operator==(const MessageKey&) const = default;

 private:
  std::array<std::uint8_t, kBytes> bytes_{};
};

}  // namespace waymark
