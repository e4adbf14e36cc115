#include "ethernet/interface.hpp"

#include <fmt/format.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "can/descriptor.hpp"

namespace servoctl::ethernet {
namespace {

/// What the kernel says of an interface; empty: it has none of this name.
class Facts {
 public:
  static std::optional<Facts> of(const std::string& name) {
    const can::Descriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    Facts out;
    ifreq request{};
    std::copy_n(name.begin(), std::min<std::size_t>(name.size(), IFNAMSIZ - 1), request.ifr_name);
    if (!socket || ::ioctl(socket.get(), SIOCGIFINDEX, &request) != 0) return std::nullopt;
    out.index = request.ifr_ifindex;
    if (::ioctl(socket.get(), SIOCGIFHWADDR, &request) != 0) return std::nullopt;
    out.type = request.ifr_hwaddr.sa_family;
    if (::ioctl(socket.get(), SIOCGIFFLAGS, &request) != 0) return std::nullopt;
    out.flags = static_cast<unsigned short>(request.ifr_flags);
    std::error_code ignored;
    out.wireless = std::filesystem::exists(formatted("/sys/class/net/{}/phy80211", name), ignored);
    return out;
  }
  bool takes_a_cable() const { return type == ARPHRD_ETHER && !wireless; }

  int index = 0;
  unsigned type = 0;
  unsigned flags = 0;
  bool wireless = false;
};

Message those_there_are() {
  const auto names = ethernet_interfaces();
  if (names.empty()) return "this machine has no Ethernet interface";
  return message("Ethernet interfaces: {}", NameList{names});
}

tl::unexpected<Error> missing(const std::string& name) {
  auto hint = did_you_mean(name, ethernet_interfaces());
  if (!hint.empty()) hint = "; " + hint;
  return fail(Errc::bus, message("there is no interface {}", as_it_is(name)),
              those_there_are() + "; `ip link` lists all interfaces" + hint);
}

tl::unexpected<Error> no_ethernet(const std::string& name, const Facts& facts) {
  if (facts.type == ARPHRD_CAN)
    return fail(Errc::bus, message("{} is a CAN interface: EtherCAT needs an Ethernet one", as_it_is(name)),
                message("for CANopen write --bus {}; {}", as_it_is(name), those_there_are()));
  if (facts.type == ARPHRD_LOOPBACK)
    return fail(Errc::bus, message("{} leads back to this machine: no drive can be on it", as_it_is(name)),
                those_there_are() + "; for simulated drives write coe:sim:FAMILY@1 or coe:local:NAME");
  if (facts.wireless)
    return fail(Errc::bus, message("{} is wireless: EtherCAT needs a cable", as_it_is(name)),
                those_there_are());
  return fail(Errc::bus, message("{} is not an Ethernet interface", as_it_is(name)), those_there_are());
}

std::string own_program() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? "servoctl" : program.string();
}

Message up_command(const std::string& name) { return message("`sudo ip link set {} up`", as_it_is(name)); }

}  // namespace

std::vector<std::string> ethernet_interfaces() {
  struct Free {
    void operator()(struct if_nameindex* list) const { ::if_freenameindex(list); }
  };
  std::vector<std::string> names;
  const std::unique_ptr<struct if_nameindex, Free> list(::if_nameindex());
  for (const auto* each = list.get(); each != nullptr && each->if_name != nullptr; ++each)
    if (const auto facts = Facts::of(each->if_name); facts && facts->takes_a_cable())
      names.emplace_back(each->if_name);
  std::sort(names.begin(), names.end());
  return names;
}

Result<int> interface_index(const std::string& name) {
  if (name.empty() || name.size() >= IFNAMSIZ || name.find('/') != std::string::npos)
    return fail(Errc::usage, message("'{}' is not an interface name", as_it_is(name)),
                "an interface has 1 to 15 characters, such as eth0; " + those_there_are());
  const auto facts = Facts::of(name);
  if (!facts) return missing(name);
  if (!facts->takes_a_cable()) return no_ethernet(name, *facts);
  if ((facts->flags & IFF_UP) == 0)
    return fail(Errc::bus, message("{} is down", as_it_is(name)), "bring it up: " + up_command(name));
  return facts->index;
}

bool has_link(const std::string& name) {
  const auto facts = Facts::of(name);
  return facts && (facts->flags & IFF_RUNNING) != 0;
}

tl::unexpected<Error> no_link(const std::string& name) {
  return fail(Errc::bus,
              message("{} has no link: no cable, or nobody with power at its other end", as_it_is(name)),
              message("plug the cable into the IN port of the first drive and switch the drive on; `ip link "
                      "show {}` says NO-CARRIER until then",
                      as_it_is(name)));
}

tl::unexpected<Error> no_right(const std::string& name) {
  return fail(Errc::bus, message("no right to send Ethernet frames on {}", as_it_is(name)),
              message("grant it to this program: `sudo setcap cap_net_raw+ep {}` (again after each update of "
                      "it), or run it with sudo",
                      as_it_is(own_program())));
}

tl::unexpected<Error> interface_lost(const std::string& name, int error) {
  const auto facts = Facts::of(name);
  if (!facts)
    return fail(Errc::bus, message("{} went down: the interface is gone", as_it_is(name)),
                "was the adapter unplugged? plug it in, then " + up_command(name));
  if ((facts->flags & IFF_UP) == 0)
    return fail(Errc::bus, message("{} went down", as_it_is(name)), "bring it up again: " + up_command(name));
  if ((facts->flags & IFF_RUNNING) == 0) return no_link(name);
  return fail(Errc::bus, message("{} failed: {}", as_it_is(name), can::system_text(error)),
              message("`ip -statistics link show {}` shows its state", as_it_is(name)));
}

tl::unexpected<Error> interface_cannot_open(const std::string& name, int error) {
  return fail(Errc::bus, message("cannot open {}: {}", as_it_is(name), can::system_text(error)),
              message("`ip link show {}` shows its state", as_it_is(name)));
}

}  // namespace servoctl::ethernet
