#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// Where LCM's messages go, as its address says.
struct LcmUrl {
  /// The multicast group; nullopt: they stay within the process (memq://).
  std::optional<in_addr> group;
  std::uint16_t port = 7667;
  int ttl = 0;  ///< how many routers they may pass; 0: they stay on the machine

  /// "239.255.76.67:7667", or "this process".
  [[nodiscard]] std::string text() const;
};

/// Reads udpm://ADDRESS:PORT?ttl=N&recv_buf_size=N whole, or memq://. LCM itself takes what it does
/// not understand for its defaults. Errors: config for another kind of address, one that is no
/// multicast group, a port, an option or a value that LCM does not know, an option given twice.
[[nodiscard]] Expected<LcmUrl> parse_lcm_url(std::string_view url);

}  // namespace waymark
