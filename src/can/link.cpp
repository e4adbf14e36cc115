#include "can/link.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netlink/attr.h>
#include <netlink/msg.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <system_error>

#include "base/file.hpp"
#include "base/text.hpp"
#include "can/link_change.hpp"
#include "can/route_socket.hpp"

namespace servoctl::can {
namespace {

/// What stands in an attribute; empty when that is too short. Longer ones come with newer kernels.
template <class T>
std::optional<T> held_by(const nlattr* attribute) {
  if (nla_len(attribute) < static_cast<int>(sizeof(T))) return std::nullopt;
  T out;
  std::memcpy(&out, nla_data(attribute), sizeof out);
  return out;
}

/// The attributes one after the other; what is cut short ends them.
void for_each_attribute(const nlattr* at, int left, const std::function<void(const nlattr*)>& take) {
  for (; nla_ok(at, left) != 0; at = nla_next(at, &left)) take(at);
}

void for_each_inside(const nlattr* attribute, const std::function<void(const nlattr*)>& take) {
  for_each_attribute(static_cast<const nlattr*>(nla_data(attribute)), nla_len(attribute), take);
}

/// A text that ends with its zero, or with the attribute.
std::string text_of(const nlattr* attribute) {
  const auto* begin = static_cast<const char*>(nla_data(attribute));
  return {begin, ::strnlen(begin, static_cast<std::size_t>(nla_len(attribute)))};
}

void take_timing(LinkState& out, const can_bittiming& timing) {
  if (timing.bitrate == 0) return;
  out.bitrate = timing.bitrate;
  if (timing.sample_point > 0) out.sample_point = static_cast<std::uint16_t>(timing.sample_point);
  if (timing.tq > 0) out.quanta = 1 + timing.prop_seg + timing.phase_seg1 + timing.phase_seg2;
}

void take_modes(LinkState& out, const can_ctrlmode& modes) {
  out.listen_only = (modes.flags & CAN_CTRLMODE_LISTENONLY) != 0;
  out.loopback = (modes.flags & CAN_CTRLMODE_LOOPBACK) != 0;
}

void take_bitrates(LinkState& out, const nlattr* attribute) {
  out.bitrates.resize(static_cast<std::size_t>(nla_len(attribute)) / sizeof(std::uint32_t));
  std::memcpy(out.bitrates.data(), nla_data(attribute), out.bitrates.size() * sizeof(std::uint32_t));
}

void take_supported(LinkState& out, const nlattr* attribute) {
  for_each_inside(attribute, [&](const nlattr* inner) {
    if (nla_type(inner) != IFLA_CAN_CTRLMODE_SUPPORTED) return;
    if (const auto modes = held_by<std::uint32_t>(inner))
      out.can_listen_only = (*modes & CAN_CTRLMODE_LISTENONLY) != 0;
  });
}

void take_health(LinkState& out, const nlattr* attribute) {
  const auto state = held_by<std::uint32_t>(attribute);
  if (state && *state <= static_cast<std::uint32_t>(LinkHealth::sleeping))
    out.health = static_cast<LinkHealth>(*state);
}

void take_counters(LinkState& out, const nlattr* attribute) {
  if (const auto counters = held_by<can_berr_counter>(attribute)) {
    out.tx_errors = counters->txerr;
    out.rx_errors = counters->rxerr;
  }
}

void take_can_attribute(LinkState& out, const nlattr* attribute) {
  switch (nla_type(attribute)) {
    case IFLA_CAN_BITTIMING:
      if (const auto timing = held_by<can_bittiming>(attribute)) take_timing(out, *timing);
      break;
    case IFLA_CAN_STATE: take_health(out, attribute); break;
    case IFLA_CAN_BERR_COUNTER: take_counters(out, attribute); break;
    case IFLA_CAN_CLOCK: out.clock = held_by<std::uint32_t>(attribute).value_or(0); break;
    case IFLA_CAN_CTRLMODE:
      if (const auto modes = held_by<can_ctrlmode>(attribute)) take_modes(out, *modes);
      break;
    case IFLA_CAN_RESTART_MS: out.restart_ms = held_by<std::uint32_t>(attribute); break;
    case IFLA_CAN_BITRATE_CONST: take_bitrates(out, attribute); break;
    case IFLA_CAN_TERMINATION: out.termination = held_by<std::uint16_t>(attribute); break;
    case IFLA_CAN_CTRLMODE_EXT: take_supported(out, attribute); break;
    default: break;
  }
}

void take_history(LinkState& out, const nlattr* attribute) {
  if (const auto told = held_by<can_device_stats>(attribute))
    out.history = {told->bus_error, told->error_warning,    told->error_passive,
                   told->bus_off,   told->arbitration_lost, told->restarts};
}

void take_kind(LinkState& out, const nlattr* attribute) {
  for_each_inside(attribute, [&](const nlattr* inner) {
    if (nla_type(inner) == IFLA_INFO_KIND) out.kind = text_of(inner);
    if (out.kind != "can") return;
    if (nla_type(inner) == IFLA_INFO_XSTATS) take_history(out, inner);
    if (nla_type(inner) == IFLA_INFO_DATA)
      for_each_inside(inner, [&](const nlattr* each) { take_can_attribute(out, each); });
  });
}

void take_traffic(LinkState& out, const nlattr* attribute) {
  // Newer kernels add to its end; this much all of them have.
  rtnl_link_stats64 told{};
  const auto size = std::min(sizeof told, static_cast<std::size_t>(nla_len(attribute)));
  std::memcpy(&told, nla_data(attribute), size);
  out.traffic = {told.rx_packets, told.tx_packets, told.rx_errors,     told.tx_errors,
                 told.rx_dropped, told.tx_dropped, told.rx_over_errors};
}

}  // namespace

std::string_view name(LinkHealth health) {
  constexpr std::array<std::string_view, 6> kNames{"error-active", "error-warning", "error-passive",
                                                   "bus-off",      "stopped",       "sleeping"};
  return kNames[static_cast<std::size_t>(health)];
}

std::optional<LinkState> parse_link(ByteSpan message) {
  Bytes copy(message.begin(), message.end());  // libnl wants it aligned.
  copy.resize(std::max(copy.size(), sizeof(nlmsghdr)));
  const auto* head = reinterpret_cast<const nlmsghdr*>(copy.data());
  if (nlmsg_ok(head, static_cast<int>(message.size())) == 0 || head->nlmsg_type != RTM_NEWLINK ||
      nlmsg_valid_hdr(head, sizeof(ifinfomsg)) == 0)
    return std::nullopt;
  LinkState out;
  ifinfomsg info;
  std::memcpy(&info, nlmsg_data(head), sizeof info);
  out.up = (info.ifi_flags & unsigned{IFF_UP}) != 0;
  for_each_attribute(nlmsg_attrdata(head, sizeof info), nlmsg_attrlen(head, sizeof info),
                     [&](const nlattr* attribute) {
                       if (nla_type(attribute) == IFLA_LINKINFO) take_kind(out, attribute);
                       if (nla_type(attribute) == IFLA_STATS64) take_traffic(out, attribute);
                       if (nla_type(attribute) == IFLA_TXQLEN)
                         out.queue_length = held_by<std::uint32_t>(attribute).value_or(0);
                     });
  return out;
}

bool is_interface(const std::string& name) { return ::if_nametoindex(name.c_str()) != 0; }

std::optional<LinkState> link_state(std::string_view interface_name) {
  const auto index = ::if_nametoindex(std::string(interface_name).c_str());
  if (index == 0) return std::nullopt;
  const auto answer = ask_route(link_question(index));
  return answer.error == 0 ? parse_link(answer.message) : std::nullopt;
}

std::string link_driver(const std::string& name) {
  std::error_code error;
  const auto target = std::filesystem::read_symlink("/sys/class/net/" + name + "/device/driver", error);
  return error ? std::string() : target.filename().string();
}

std::size_t count_receivers(std::string_view lists, std::string_view name) {
  std::set<std::string_view> sockets;
  for (const auto line : split(lists, '\n')) {
    std::vector<std::string_view> words;
    for (const auto word : split(line, ' '))
      if (!word.empty()) words.push_back(word);
    // device can_id can_mask function userdata matches ident
    if (words.size() >= 7 && words[0] == name) sockets.insert(words[4]);
  }
  return sockets.size();
}

std::size_t link_receivers(const std::string& name) {
  std::string lists;
  for (const auto* list : {"all", "fil", "inv", "sff", "eff", "err"})
    if (const auto text = read_file(std::string("/proc/net/can/rcvlist_") + list)) lists += *text + "\n";
  return count_receivers(lists, name);
}

}  // namespace servoctl::can
