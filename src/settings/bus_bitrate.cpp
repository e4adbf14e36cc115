#include "settings/bus_bitrate.hpp"

#include <utility>

#include "base/format.hpp"
#include "drive/bitrate.hpp"

namespace servoctl::settings {
namespace {

/// So long may an adapter take to come up.
constexpr Duration kInterfaceComesUp = std::chrono::seconds(2);

}  // namespace

std::string old_bitrate_text(const BitrateSwitch& plan) {
  return plan.before.bitrate ? drive::bitrate_text(*plan.before.bitrate) : "the old bitrate";
}

Result<BitrateSwitch> plan_bus_bitrate(std::unique_ptr<can::LinkControl> link, std::uint32_t bitrate,
                                       const std::optional<bool>& may_change) {
  BitrateSwitch out{.bitrate = bitrate};
  if (!link) return out;
  const auto now = link->state();
  if (!now) return fail(now.error());
  if (now->kind != "can") return out;
  out.link = std::move(link);
  out.before = *now;
  if (now->bitrate == bitrate)
    out.why_not = formatted("it has {} already", drive::bitrate_text(bitrate));
  else if (may_change == false)
    out.why_not = "it needs the right CAP_NET_ADMIN: " + can::right_command();
  return out;
}

Result<void> take_to(session::Session& session, BitrateSwitch& plan, std::uint32_t bitrate) {
  const auto now = plan.link->state();
  if (!now) return fail(now.error());
  const auto steps = session::plan_bus_up(plan.link->name(), *now, {.bitrate = bitrate});
  if (!steps) return fail(steps.error());
  if (const auto set = session::set_up(*plan.link, *now, *steps); !set) return set;
  return session.network().recover(session.now() + kInterfaceComesUp);
}

Result<bool> take_back(session::Session& session, BitrateSwitch& plan, const std::function<bool()>& answers) {
  if (!plan.before.bitrate || !take_to(session, plan, *plan.before.bitrate)) return false;
  if (answers()) return true;
  if (const auto forth = take_to(session, plan, plan.bitrate); !forth) return fail(forth.error());
  return false;
}

std::string lss_switch_text(const BitrateSwitch& plan) {
  return formatted("{} goes with them to {} (from {})", plan.link->name(), drive::bitrate_text(plan.bitrate),
                   session::settings_text(plan.before));
}

std::string lss_switch_commands(const BitrateSwitch& plan) {
  const auto& name = plan.link->name();
  return formatted("`{}`, `{}`", can::ip_command(name, {.up = false}),
                   can::ip_command(name, {.up = true, .bitrate = plan.bitrate}));
}

}  // namespace servoctl::settings
