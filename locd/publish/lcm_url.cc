#include "locd/publish/lcm_url.h"

#include <arpa/inet.h>

#include <array>

#include "core/base/text_field.h"

namespace waymark {
namespace {

constexpr std::string_view kUdp = "udpm://";
constexpr std::string_view kMemory = "memq://";
constexpr std::string_view kGroup = "239.255.76.67";  // LCM's own default
constexpr std::int64_t kMaxTtl = 255;
constexpr std::int64_t kMaxReceiveBuffer = std::int64_t{1} << 30;

/// The text before the first `separator`, which is taken away with it.
std::string_view take_until(std::string_view& rest, char separator) {
  const auto end = rest.find(separator);
  const std::string_view taken = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  return taken;
}

class Reader {
 public:
  Expected<LcmUrl> read(std::string_view rest) {
    std::string_view options = rest;
    std::string_view place = take_until(options, '?');
    const bool has_port = place.find(':') != std::string_view::npos;
    const std::string_view host = take_until(place, ':');
    Status read = read_group(host.empty() ? kGroup : host);
    if (read && has_port) read = read_port(place);
    while (read && !options.empty()) read = read_option(take_until(options, '&'));
    if (!read) return tl::make_unexpected(read.error());
    return url_;
  }

 private:
  Status read_group(std::string_view host) {
    in_addr group{};
    if (::inet_pton(AF_INET, std::string(host).c_str(), &group) != 1 ||
        host.find('\0') != std::string_view::npos) {
      return fail(ErrorKind::config, "{} is no IPv4 address, as 239.255.76.67 is one", host);
    }
    if (!IN_MULTICAST(ntohl(group.s_addr))) {
      return fail(
          ErrorKind::config,
          "{} is no multicast address (224.0.0.0 to 239.255.255.255); listeners need not be "
          "named: whoever hears the group hears poses",
          host);
    }
    url_.group = group;
    return {};
  }

  Status read_port(std::string_view text) {
    const auto port = parse_whole<std::uint16_t>(text);
    if (!port || *port == 0) {
      return fail(ErrorKind::config, "port \"{}\" must be a whole number from 1 to 65535", text);
    }
    url_.port = *port;
    return {};
  }

  Status read_option(std::string_view value) {
    const std::string_view key = take_until(value, '=');
    if (key == "ttl") return read_number(key, value, 0, kMaxTtl, ttl_);
    if (key == "recv_buf_size") return read_number(key, value, 1, kMaxReceiveBuffer, buffer_);
    return fail(ErrorKind::config, "unknown option {}; known: ttl, recv_buf_size", key);
  }

  Status read_number(std::string_view key, std::string_view text, std::int64_t low,
                     std::int64_t high, std::optional<std::int64_t>& number) {
    if (number) return fail(ErrorKind::config, "{} is given twice", key);
    number = parse_whole<std::int64_t>(text);
    if (!number || *number < low || *number > high) {
      return fail(ErrorKind::config, "{} = \"{}\" must be a whole number from {} to {}", key, text,
                  low, high);
    }
    url_.ttl = static_cast<int>(ttl_.value_or(0));
    return {};
  }

  LcmUrl url_;
  std::optional<std::int64_t> ttl_;
  std::optional<std::int64_t> buffer_;
};

}  // namespace

std::string LcmUrl::text() const {
  if (!group) return "this process";
  std::array<char, INET_ADDRSTRLEN> address{};
  ::inet_ntop(AF_INET, &*group, address.data(), address.size());
  return fmt::format("{}:{}", address.data(), port);
}

Expected<LcmUrl> parse_lcm_url(std::string_view url) {
  // Never a file: a disk that stalls would hold up poses. lcm-logger writes one.
  if (url.starts_with(kMemory)) {
    if (url == kMemory) return LcmUrl{};
    return fail(ErrorKind::config, "\"{}\": {} takes neither address nor options", url, kMemory);
  }
  if (!url.starts_with(kUdp)) {
    return fail(ErrorKind::config, "\"{}\" must begin with {} (a multicast group) or {}", url, kUdp,
                kMemory);
  }
  return Reader().read(url.substr(kUdp.size()));
}

}  // namespace waymark
