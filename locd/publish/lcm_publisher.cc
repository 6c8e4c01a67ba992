#include "locd/publish/lcm_publisher.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "core/base/check.h"
#include "core/base/descriptor.h"

namespace waymark {
namespace {

/// Whether a packet to the address would find a way. Asked before LCM is, which prints a line for
/// every attempt that fails.
bool has_route(const LcmUrl& url) {
  if (!url.group) return true;
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket.valid()) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = *url.group;
  address.sin_port = htons(url.port);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how sockets take addresses
  return ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

/// The address as LCM takes it, with nothing left for it to guess.
std::string url_for_lcm(const LcmUrl& url) {
  return url.group ? fmt::format("udpm://{}?ttl={}", url.text(), url.ttl) : "memq://";
}

bool is_udp(int descriptor) {
  int domain = 0;
  int type = 0;
  socklen_t size = sizeof domain;
  return ::getsockopt(descriptor, SOL_SOCKET, SO_DOMAIN, &domain, &size) == 0 &&
         ::getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && domain == AF_INET &&
         type == SOCK_DGRAM;
}

/// LCM would wait for a network that takes no packets, on a descriptor that it does not tell: all
/// of this process's UDP sockets are LCM's. Descriptors are given lowest first, and locd has few
/// hundred.
void let_no_udp_socket_wait() {
  constexpr int kDescriptors = 4096;
  for (int descriptor = 0; descriptor < kDescriptors; ++descriptor) {
    if (!is_udp(descriptor)) continue;
    const int flags = ::fcntl(descriptor, F_GETFL);
    if (flags >= 0) ::fcntl(descriptor, F_SETFL, flags | O_NONBLOCK);
  }
}

LcmPublisher::Link link_after(int error_number) {
  switch (error_number) {
    case EAGAIN:
    case ENOBUFS:
      return LcmPublisher::Link::full;
    case EPERM:
    case EACCES:
      return LcmPublisher::Link::not_allowed;
    case ENETUNREACH:
    case EHOSTUNREACH:
    case ENETDOWN:
      return LcmPublisher::Link::no_route;
    default:
      return LcmPublisher::Link::failing;
  }
}

}  // namespace

LcmPublisher::LcmPublisher(std::string_view url, Stamp now)
    : url_([&] {
        auto parsed = parse_lcm_url(url);
        WAYMARK_CHECK(parsed);
        return std::move(*parsed);
      }()),
      buffer_(kMaxMessageBytes) {
  connect(now);
}

std::int64_t LcmPublisher::failures() const {
  const std::lock_guard lock(mutex_);
  return failures_;
}

LcmPublisher::Link LcmPublisher::last_failure() const {
  const std::lock_guard lock(mutex_);
  return last_failure_;
}

void LcmPublisher::connect(Stamp now) {
  lcm_.reset();
  if (has_route(url_)) lcm_ = std::make_unique<lcm::LCM>(url_for_lcm(url_));
  if (lcm_ != nullptr && !lcm_->good()) lcm_.reset();
  last_taken_ = lcm_ != nullptr;
  if (last_taken_) {
    if (url_.group) let_no_udp_socket_wait();
    retry_after_ = kFirstRetry;
    failing_since_ = now;
    return;
  }
  retry_at_ = now + retry_after_;
  retry_after_ = std::min(2 * retry_after_, kLongestRetry);
}

bool LcmPublisher::send(const std::string& channel, unsigned size, Stamp now) {
  if (lcm_ == nullptr && now >= retry_at_) connect(now);
  if (lcm_ == nullptr) return refuse(Link::no_route);
  const bool was_taken = last_taken_;
  errno = 0;
  last_taken_ = lcm_->publish(channel, buffer_.data(), size) == 0;
  if (last_taken_) return true;
  const Link link = link_after(errno);
  if (was_taken || link == Link::full) failing_since_ = now;
  if (now - failing_since_ >= kRenew) {
    lcm_.reset();
    retry_at_ = now;
  }
  return refuse(link);
}

bool LcmPublisher::refuse(Link why) {
  last_failure_ = why;
  ++failures_;
  return false;
}

std::string describe(LcmPublisher::Link link, const LcmUrl& address) {
  const std::string to = address.text();
  switch (link) {
    case LcmPublisher::Link::up:
      return "all messages are taken";
    case LcmPublisher::Link::no_route:
      return fmt::format("there is no route to {}; add one: docs/operations.md, Multicast", to);
    case LcmPublisher::Link::full:
      return "the network takes no packets; is the interface up, does Wi-Fi have its access point?";
    case LcmPublisher::Link::not_allowed:
      return fmt::format(
          "no packet may leave to {}; add IPAddressAllow= for that group to the unit, or look at "
          "the firewall",
          to);
    case LcmPublisher::Link::too_large:
      return "a message is too large to send";
    case LcmPublisher::Link::failing:
      return fmt::format("packets to {} are refused", to);
  }
  return {};
}

}  // namespace waymark
