#include "locd/publish/multicast_route.h"

#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <cstring>

#include "core/base/descriptor.h"

namespace waymark {
namespace {

struct RouteQuestion {
  nlmsghdr header{};
  rtmsg route{};
  rtattr attribute{};
  in_addr group{};
};

bool ask(int socket, in_addr group) {
  RouteQuestion question;
  question.header.nlmsg_len = sizeof question;
  question.header.nlmsg_type = RTM_GETROUTE;
  question.header.nlmsg_flags = NLM_F_REQUEST;
  question.route.rtm_family = AF_INET;
  question.route.rtm_dst_len = 32;
  question.attribute.rta_type = RTA_DST;
  question.attribute.rta_len = RTA_LENGTH(sizeof group);
  question.group = group;
  return ::send(socket, &question, sizeof question, 0) == sizeof question;
}

/// The number of the interface in the kernel's answer; 0: there is none.
unsigned interface_in(const char* answer, std::size_t size) {
  nlmsghdr header{};
  if (size < sizeof header) return 0;
  std::memcpy(&header, answer, sizeof header);
  if (header.nlmsg_type != RTM_NEWROUTE || header.nlmsg_len > size) return 0;
  for (std::size_t at = NLMSG_LENGTH(sizeof(rtmsg)); at + sizeof(rtattr) <= header.nlmsg_len;) {
    rtattr attribute{};
    std::memcpy(&attribute, answer + at, sizeof attribute);
    if (attribute.rta_len < sizeof attribute || at + attribute.rta_len > header.nlmsg_len) return 0;
    if (attribute.rta_type == RTA_OIF && attribute.rta_len == RTA_LENGTH(sizeof(unsigned))) {
      unsigned number = 0;
      std::memcpy(&number, answer + at + RTA_LENGTH(0), sizeof number);
      return number;
    }
    at += RTA_ALIGN(attribute.rta_len);
  }
  return 0;
}

}  // namespace

std::optional<std::string> interface_to(in_addr group) {
  const Descriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (!socket.valid() || !ask(socket.get(), group)) return std::nullopt;
  std::array<char, 8192> answer{};
  const ssize_t got = ::recv(socket.get(), answer.data(), answer.size(), 0);
  const unsigned number = interface_in(answer.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  std::array<char, IF_NAMESIZE> name{};
  if (number == 0 || ::if_indextoname(number, name.data()) == nullptr) return std::nullopt;
  return name.data();
}

std::string describe_route(const LcmUrl& url) {
  if (!url.group) return "[lcm] url is memq://: nobody hears poses outside this process";
  const auto interface = interface_to(*url.group);
  const std::string to = url.text();
  if (!interface) {
    return fmt::format("there is no route to {}: nobody hears poses; docs/operations.md, Multicast",
                       to);
  }
  if (*interface == "lo") {
    return fmt::format(
        "poses to {} leave by lo: other machines neither hear them nor can send any like them{}",
        to, url.ttl > 0 ? "; ttl=0 would do" : "");
  }
  if (url.ttl > 0) {
    return fmt::format(
        "poses to {} leave by {}: whoever is in its network hears them and can send what looks "
        "like "
        "them; [lcm] key_file tells which are ours",
        to, *interface);
  }
  return fmt::format(
      "poses to {} stay on this machine, but whoever is in the network of {} can send what looks "
      "like "
      "them; keep it out: ip route add 239.0.0.0/8 dev lo",
      to, *interface);
}

}  // namespace waymark
