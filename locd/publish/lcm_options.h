#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace waymark {

/// [lcm] of locd.toml: where messages go.
struct LcmOptions {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string channel_prefix = "WAYMARK";
  bool detections = false;         ///< publish WAYMARK_DETECTIONS
  std::filesystem::path key_file;  ///< what poses are signed with; empty: they are not
  bool operator==(const LcmOptions&) const = default;
};

/// LCM's channel names end at 63 characters; the longest of ours ends in "_SIGNED_POSE".
inline constexpr std::size_t kLongestChannelPrefix = 50;

/// Whether messages can go to channels that begin with this: 1 to kLongestChannelPrefix characters
/// of ASCII, none of them a blank.
[[nodiscard]] bool is_channel_prefix(std::string_view text);

}  // namespace waymark
