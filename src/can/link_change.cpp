#include "can/link_change.hpp"

#include <linux/can/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netlink/attr.h>
#include <netlink/msg.h>

#include <cerrno>
#include <memory>
#include <string_view>

#include "base/format.hpp"
#include "can/route_socket.hpp"
#include "can/socketcan.hpp"
#include "can/socketcan_error.hpp"

namespace servoctl::can {
namespace {

/// A message that is put together.
class RouteMessage {
 public:
  RouteMessage(int type, int flags, const ifinfomsg& info)
      : message_(nlmsg_alloc_simple(type, NLM_F_REQUEST | flags), &nlmsg_free) {
    auto copy = info;
    nlmsg_append(message_.get(), &copy, sizeof copy, NLMSG_ALIGNTO);
  }

  template <class T>
  void put(int type, const T& value) {
    nla_put(message_.get(), type, sizeof value, &value);
  }
  void put_text(int type, std::string_view text) {
    nla_put(message_.get(), type, static_cast<int>(text.size()), text.data());
  }
  /// What is put from now on stands inside, until end(). Without the mark of a nest, as iproute2 sends it.
  nlattr* begin(int type) {
    auto* const here = static_cast<nlattr*>(nlmsg_tail(nlmsg_hdr(message_.get())));
    nla_put(message_.get(), type, 0, nullptr);
    return here;
  }
  void end(nlattr* nest) { nla_nest_end(message_.get(), nest); }

  Bytes bytes() const {
    const auto* head = nlmsg_hdr(message_.get());
    const auto* data = reinterpret_cast<const std::uint8_t*>(head);
    return {data, data + head->nlmsg_len};
  }

 private:
  std::unique_ptr<nl_msg, decltype(&nlmsg_free)> message_;
};

ifinfomsg info_of(unsigned index) {
  ifinfomsg info{};
  info.ifi_family = AF_UNSPEC;
  info.ifi_index = static_cast<int>(index);
  return info;
}

bool sets_controller(const LinkChange& change) {
  return change.bitrate || change.restart_ms || change.listen_only;
}

void put_controller(RouteMessage& message, const LinkChange& change) {
  auto* const link_info = message.begin(IFLA_LINKINFO);
  message.put_text(IFLA_INFO_KIND, "can");
  auto* const data = message.begin(IFLA_INFO_DATA);
  if (change.restart_ms) message.put(IFLA_CAN_RESTART_MS, *change.restart_ms);
  if (change.bitrate) {
    can_bittiming timing{};
    timing.bitrate = *change.bitrate;
    timing.sample_point = change.sample_point.value_or(0);
    message.put(IFLA_CAN_BITTIMING, timing);
  }
  if (change.listen_only) {
    const std::uint32_t mode = CAN_CTRLMODE_LISTENONLY;
    message.put(IFLA_CAN_CTRLMODE, can_ctrlmode{mode, *change.listen_only ? mode : 0});
  }
  message.end(data);
  message.end(link_info);
}

class KernelLink final : public LinkControl {
 public:
  KernelLink(std::string name, unsigned index) : name_(std::move(name)), index_(index) {}

  const std::string& name() const override { return name_; }
  Result<LinkState> state() override {
    auto state = link_state(name_);
    if (!state) return interface_missing(name_);
    return std::move(*state);
  }
  Result<void> change(const LinkChange& change) override {
    const auto answer = ask_route(link_message(index_, change));
    if (answer.error == 0) return {};
    return fail(
        link_refusal(name_, change, link_state(name_).value_or(LinkState{}), answer.error, answer.words));
  }
  Result<std::unique_ptr<Bus>> listen() override { return open_socketcan_listener(name_); }

 private:
  std::string name_;
  unsigned index_;
};

}  // namespace

Bytes link_question(unsigned index) { return RouteMessage(RTM_GETLINK, 0, info_of(index)).bytes(); }

Bytes link_message(unsigned index, const LinkChange& change) {
  auto info = info_of(index);
  if (change.up) {
    info.ifi_change = IFF_UP;
    info.ifi_flags = *change.up ? unsigned{IFF_UP} : 0;
  }
  RouteMessage message(RTM_NEWLINK, NLM_F_ACK, info);
  if (change.queue_length) message.put(IFLA_TXQLEN, *change.queue_length);
  if (sets_controller(change)) put_controller(message, change);
  return message.bytes();
}

std::string ip_command(const std::string& name, const LinkChange& change) {
  auto out = formatted("ip link set {}", name);
  if (change.up) out += *change.up ? " up" : " down";
  if (change.queue_length) out += formatted(" txqueuelen {}", *change.queue_length);
  if (sets_controller(change)) out += " type can";
  if (change.bitrate) out += formatted(" bitrate {}", *change.bitrate);
  if (change.bitrate && change.sample_point)
    out += formatted(" sample-point {:.3f}", *change.sample_point / 1000.0);
  if (change.restart_ms) out += formatted(" restart-ms {}", *change.restart_ms);
  if (change.listen_only) out += formatted(" listen-only {}", *change.listen_only ? "on" : "off");
  return out;
}

std::optional<bool> may_change_links(int error) {
  // A user who may change one is told that none was named.
  if (error == EINVAL || error == ENODEV) return true;
  if (error == EPERM || error == EACCES) return false;
  return std::nullopt;
}

std::optional<bool> may_change_links() {
  // RTM_SETLINK, unlike RTM_NEWLINK, makes no interface where none is named.
  return may_change_links(ask_route(RouteMessage(RTM_SETLINK, NLM_F_ACK, info_of(0)).bytes()).error);
}

std::string right_command() {
  return "run it with `sudo`, or give servoctl the right CAP_NET_ADMIN for everybody who may start it: `sudo setcap "
         "cap_net_admin+ep \"$(readlink -f \"$(command -v servoctl)\")\"`";
}

Result<std::unique_ptr<LinkControl>> open_link(const std::string& name) {
  if (name.empty() || name.size() >= IFNAMSIZ || name.find('/') != std::string::npos)
    return interface_no_name(name);
  const auto index = ::if_nametoindex(name.c_str());
  if (index == 0) return interface_missing(name);
  if (!is_can_interface(name)) return interface_is_no_can(name);
  return std::make_unique<KernelLink>(name, index);
}

Result<void> LinkKeeper::put_back() {
  if (link_ == nullptr) return {};
  auto& link = *std::exchange(link_, nullptr);
  if (const auto down = link.change({.up = false}); !down) return down;
  LinkChange back;
  back.bitrate = before_.bitrate;
  if (before_.bitrate) back.sample_point = before_.sample_point;
  const auto now = link.state();
  if (now && now->listen_only != before_.listen_only) back.listen_only = before_.listen_only;
  if (now && before_.restart_ms && now->restart_ms != before_.restart_ms)
    back.restart_ms = before_.restart_ms;
  if (before_.up) back.up = true;
  return link.change(back);
}

}  // namespace servoctl::can
