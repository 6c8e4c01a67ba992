#pragma once

#include <netinet/in.h>

#include <optional>
#include <string>

#include "locd/publish/lcm_url.h"

namespace waymark {

/// The interface by which packets to a group leave this machine, and by which its listeners hear:
/// "lo", "eth0"; nullopt: there is no route to it.
[[nodiscard]] std::optional<std::string> interface_to(in_addr group);

/// A line for people: by which interface messages leave, who may hear them and who may send what
/// looks like them, and what keeps others out.
[[nodiscard]] std::string describe_route(const LcmUrl& url);

}  // namespace waymark
