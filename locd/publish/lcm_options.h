#pragma once

#include <filesystem>
#include <string>

namespace waymark {

/// [lcm] of locd.toml: where messages go.
struct LcmOptions {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string channel_prefix = "WAYMARK";
  bool detections = false;         ///< publish WAYMARK_DETECTIONS
  std::filesystem::path key_file;  ///< what poses are signed with; empty: they are not
  bool operator==(const LcmOptions&) const = default;
};

}  // namespace waymark
