#include "locd/publish/lcm_publisher.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "core/base/text_field.h"

namespace waymark {
namespace {

/// "udpm://ADDRESS:PORT?…" as the kernel takes it; nullopt for other kinds of address.
std::optional<sockaddr_in> multicast_address(const std::string& url) {
  constexpr std::string_view kUdp = "udpm://";
  if (!url.starts_with(kUdp)) return std::nullopt;
  std::string_view rest = std::string_view(url).substr(kUdp.size());
  rest = rest.substr(0, rest.find('?'));
  const auto colon = rest.find(':');
  const std::string host(colon == 0 || rest.empty() ? "239.255.76.67" : rest.substr(0, colon));
  const auto port = colon == std::string_view::npos
                        ? std::optional<std::uint16_t>(7667)
                        : parse_whole<std::uint16_t>(rest.substr(colon + 1));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (!port || ::inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) return std::nullopt;
  address.sin_port = htons(*port);
  return address;
}

/// Whether a packet to the address would find a way. Asked before LCM is, which prints a line for
/// every attempt that fails.
bool has_route(const std::string& url) {
  const auto address = multicast_address(url);
  if (!address) return true;
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return false;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how sockets take addresses
  const bool found =
      ::connect(socket, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0;
  ::close(socket);
  return found;
}

}  // namespace

LcmPublisher::LcmPublisher(std::string url, Stamp now)
    : url_(std::move(url)), buffer_(kMaxMessageBytes) {
  connect(now);
}

std::int64_t LcmPublisher::failures() const {
  const std::lock_guard lock(mutex_);
  return failures_;
}

bool LcmPublisher::connected() const {
  const std::lock_guard lock(mutex_);
  return last_taken_;
}

void LcmPublisher::connect(Stamp now) {
  lcm_.reset();
  if (has_route(url_)) lcm_ = std::make_unique<lcm::LCM>(url_);
  if (lcm_ != nullptr && !lcm_->good()) lcm_.reset();
  last_taken_ = lcm_ != nullptr;
  if (last_taken_) {
    retry_after_ = kFirstRetry;
    failing_since_ = now;
    return;
  }
  retry_at_ = now + retry_after_;
  retry_after_ = std::min(2 * retry_after_, kLongestRetry);
}

bool LcmPublisher::send(const std::string& channel, unsigned size, Stamp now) {
  if (lcm_ == nullptr && now >= retry_at_) connect(now);
  const bool was_taken = last_taken_;
  last_taken_ = lcm_ != nullptr && lcm_->publish(channel, buffer_.data(), size) == 0;
  if (last_taken_) return true;
  ++failures_;
  if (was_taken) failing_since_ = now;
  if (lcm_ != nullptr && now - failing_since_ >= kRenew) {
    lcm_.reset();
    retry_at_ = now;
  }
  return false;
}

}  // namespace waymark
