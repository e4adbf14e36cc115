#include "can/link.hpp"

#include <linux/can/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <string>

#include "can/descriptor.hpp"

namespace servoctl::can {
namespace {

constexpr std::uint16_t kTypeMask = 0x3FFF;  ///< NLA_TYPE_MASK (linux/netlink.h), which is a negative number.
constexpr Duration kPatience = std::chrono::milliseconds(200);

template <class T>
std::optional<T> load(ByteSpan bytes, std::size_t at = 0) {
  if (bytes.size() < at + sizeof(T)) return std::nullopt;
  T out;
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

/// The attributes one after the other; what is cut short ends them.
void for_each_attribute(ByteSpan bytes, const std::function<void(std::uint16_t type, ByteSpan data)>& take) {
  while (const auto head = load<rtattr>(bytes)) {
    if (head->rta_len < sizeof(rtattr) || head->rta_len > bytes.size()) return;
    take(head->rta_type & kTypeMask, bytes.subspan(sizeof(rtattr), head->rta_len - sizeof(rtattr)));
    bytes = bytes.subspan(std::min<std::size_t>(bytes.size(), RTA_ALIGN(head->rta_len)));
  }
}

/// A text that ends with its zero.
std::string text_of(ByteSpan bytes) {
  return {bytes.begin(), std::find(bytes.begin(), bytes.end(), std::uint8_t{0})};
}

void take_can_attribute(LinkState& out, std::uint16_t type, ByteSpan data) {
  if (type == IFLA_CAN_BITTIMING)
    if (const auto timing = load<can_bittiming>(data); timing && timing->bitrate > 0)
      out.bitrate = timing->bitrate;
  if (type == IFLA_CAN_STATE)
    if (const auto state = load<std::uint32_t>(data);
        state && *state <= static_cast<std::uint32_t>(LinkHealth::sleeping))
      out.health = static_cast<LinkHealth>(*state);
  if (type == IFLA_CAN_BERR_COUNTER)
    if (const auto counters = load<can_berr_counter>(data)) {
      out.tx_errors = counters->txerr;
      out.rx_errors = counters->rxerr;
    }
}

/// Asks for one interface by its number.
bool send_question(int fd, unsigned index) {
  struct {
    nlmsghdr head;
    ifinfomsg info;
  } question{};
  question.head.nlmsg_len = sizeof question;
  question.head.nlmsg_type = RTM_GETLINK;
  question.head.nlmsg_flags = NLM_F_REQUEST;
  question.info.ifi_family = AF_UNSPEC;
  question.info.ifi_index = static_cast<int>(index);
  return ::send(fd, &question, sizeof question, 0) == static_cast<ssize_t>(sizeof question);
}

}  // namespace

std::string_view name(LinkHealth health) {
  constexpr std::array<std::string_view, 6> kNames{"error-active", "error-warning", "error-passive",
                                                   "bus-off",      "stopped",       "sleeping"};
  return kNames[static_cast<std::size_t>(health)];
}

std::optional<LinkState> parse_link(ByteSpan message) {
  const auto head = load<nlmsghdr>(message);
  if (!head || head->nlmsg_type != RTM_NEWLINK || head->nlmsg_len > message.size() ||
      head->nlmsg_len < NLMSG_LENGTH(sizeof(ifinfomsg)))
    return std::nullopt;
  LinkState out;
  const auto attributes =
      message.first(head->nlmsg_len).subspan(NLMSG_LENGTH(NLMSG_ALIGN(sizeof(ifinfomsg))));
  for_each_attribute(attributes, [&](std::uint16_t type, ByteSpan data) {
    if (type != IFLA_LINKINFO) return;
    bool is_can = false;
    for_each_attribute(data, [&](std::uint16_t inner, ByteSpan value) {
      if (inner == IFLA_INFO_KIND) is_can = text_of(value) == "can";
      if (inner == IFLA_INFO_DATA && is_can)
        for_each_attribute(value, [&](std::uint16_t t, ByteSpan d) { take_can_attribute(out, t, d); });
    });
  });
  return out;
}

bool is_interface(const std::string& name) { return ::if_nametoindex(name.c_str()) != 0; }

std::optional<LinkState> link_state(std::string_view interface_name) {
  const auto index = ::if_nametoindex(std::string(interface_name).c_str());
  const Descriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (index == 0 || !socket || !send_question(socket.get(), index)) return std::nullopt;
  if (wait_for(socket.get(), POLLIN, steady_now() + kPatience) != Wake::ready) return std::nullopt;
  std::array<std::uint8_t, 16384> answer{};
  const auto size = ::recv(socket.get(), answer.data(), answer.size(), 0);
  if (size <= 0) return std::nullopt;
  return parse_link(std::span(answer).first(static_cast<std::size_t>(size)));
}

}  // namespace servoctl::can
