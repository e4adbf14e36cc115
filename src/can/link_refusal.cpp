// What the kernel means when it does not change an interface.
#include <algorithm>
#include <cerrno>

#include "base/format.hpp"
#include "can/descriptor.hpp"
#include "can/link_change.hpp"

namespace servoctl::can {
namespace {

std::string in_kbits(std::uint32_t bitrate) {
  return bitrate % 1000 == 0 ? formatted("{} kbit/s", bitrate / 1000) : formatted("{} bit/s", bitrate);
}

std::string own_bitrates(const LinkState& now) {
  std::string out;
  for (const auto bitrate : now.bitrates) out += (out.empty() ? "" : ", ") + in_kbits(bitrate);
  return out;
}

bool sets_bits(const LinkChange& change) { return change.bitrate || change.restart_ms || change.listen_only; }

Error not_permitted(const std::string& name) {
  return make_error(Errc::bus,
                    message("{} was not changed: this user may not change interfaces", as_it_is(name)),
                    right_command());
}

Error unreachable_bitrate(const std::string& name, const LinkChange& change, const LinkState& now) {
  const auto wanted = in_kbits(change.bitrate.value_or(0));
  if (!now.bitrates.empty())
    return make_error(Errc::usage, message("{} has no bitrate of {}", as_it_is(name), wanted),
                      message("it has {}", own_bitrates(now)));
  const auto clock = now.clock > 0 ? message(" from its clock of {:g} MHz", now.clock / 1e6) : Message();
  return make_error(
      Errc::usage, message("{} cannot make {}{}", as_it_is(name), wanted, clock),
      "CiA 301 has 10k, 20k, 50k, 125k, 250k, 500k, 800k and 1M; a --sample-point that the controller "
      "cannot have is refused as well");
}

Error not_supported(const std::string& name, const LinkChange& change, const LinkState& now) {
  if (now.kind != "can")
    return make_error(
        Errc::usage,
        message("{} ({}) has no bitrate to set", as_it_is(name),
                now.kind.empty() ? Message("of another kind") : Message(as_it_is(now.kind))),
        message(
            "`bus up {}` alone brings it up; an slcan adapter of an older kernel has its bitrate from slcand "
            "or slcan_attach (-s)",
            as_it_is(name)));
  if (change.listen_only == true)
    return make_error(
        Errc::usage, message("the driver of {} cannot listen without acknowledging", as_it_is(name)),
        "only listen-only leaves a bus undisturbed at a wrong bitrate: use another adapter, or ask "
        "what the bitrate is");
  if (change.restart_ms)
    return make_error(Errc::usage,
                      message("the driver of {} does not restart by itself after a bus-off", as_it_is(name)),
                      "leave --restart-ms out; `bus up` brings it back after a bus-off");
  return make_error(Errc::usage, message("the driver of {} does not have that setting", as_it_is(name)));
}

Error invalid(const std::string& name, const LinkChange& change, const LinkState& now) {
  if (change.bitrate) return unreachable_bitrate(name, change, now);
  if (change.up == true && now.kind == "can" && !now.bitrate)
    return make_error(Errc::usage, message("{} has no bitrate yet", as_it_is(name)),
                      message("`bus up {} --bitrate 500k`, with the bitrate of the drives", as_it_is(name)));
  return make_error(Errc::usage, message("{} does not take that setting", as_it_is(name)));
}

Error of_the_adapter(const std::string& name, int error) {
  return make_error(
      Errc::bus, message("{} was not changed: {}", as_it_is(name), system_text(error)),
      "is the adapter still plugged in? `bus status` shows what there is; unplug it and plug it in "
      "again");
}

Error refusal(const std::string& name, const LinkChange& change, const LinkState& now, int error) {
  switch (error) {
    case EPERM:
    case EACCES: return not_permitted(name);
    case EBUSY:
      if (!sets_bits(change)) return of_the_adapter(name, error);
      return make_error(
          Errc::bus, message("{} is up, and has its settings changed only while it is down", as_it_is(name)),
          message("somebody else brought it up meanwhile: `bus status {}`", as_it_is(name)));
    case EOPNOTSUPP: return not_supported(name, change, now);
    case EINVAL: return invalid(name, change, now);
    case ERANGE:
    case EDOM: return unreachable_bitrate(name, change, now);
    case ENODEV:
    case ENXIO:
      return make_error(Errc::bus, message("{} is gone", as_it_is(name)), "was the adapter unplugged?");
    default: return of_the_adapter(name, error);
  }
}

}  // namespace

Error link_refusal(const std::string& name, const LinkChange& change, const LinkState& now, int error,
                   const std::string& words) {
  auto out = refusal(name, change, now, error);
  if (!words.empty()) out.message += message(" (the kernel: {})", as_it_is(words));
  return out;
}

}  // namespace servoctl::can
