#include "session/bus_setup.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>

#include "base/format.hpp"
#include "drive/bitrate.hpp"

namespace servoctl::session {
namespace {

std::string sample_point_text(std::uint16_t thousandths) { return formatted("{:.1f} %", thousandths / 10.0); }

/// Half a quantum of the bit, in which the controller has to place it; at the least what rounding costs.
int tolerance_of(const can::LinkState& now) {
  return now.quanta > 0 ? static_cast<int>(500 / now.quanta) + 1 : 1;
}

bool is_close(const can::LinkState& now, std::uint16_t wanted) {
  return now.sample_point && std::abs(int{*now.sample_point} - int{wanted}) <= tolerance_of(now);
}

std::vector<std::string> differences(const can::LinkState& now, const BusWish& wish) {
  std::vector<std::string> out;
  if (wish.bitrate && now.bitrate != wish.bitrate)
    out.push_back(formatted("{} instead of {}",
                            now.bitrate ? drive::bitrate_text(*now.bitrate) : "no bitrate",
                            drive::bitrate_text(*wish.bitrate)));
  if (wish.sample_point && !is_close(now, *wish.sample_point))
    out.push_back(formatted("sample point {} instead of {}",
                            now.sample_point ? sample_point_text(*now.sample_point) : "not known",
                            sample_point_text(*wish.sample_point)));
  if (wish.restart_ms && now.restart_ms != wish.restart_ms)
    out.push_back(formatted("restart-ms {} instead of {}", now.restart_ms.value_or(0), *wish.restart_ms));
  if (now.listen_only) out.push_back("listen-only, so that it acknowledges nothing");
  return out;
}

Result<void> check_wish(const std::string& name, const can::LinkState& now, const BusWish& wish) {
  const bool has_controller = now.kind == "can";
  if (!has_controller && (wish.bitrate || wish.sample_point || wish.restart_ms))
    return fail(can::link_refusal(name, {.bitrate = wish.bitrate.value_or(0)}, now, EOPNOTSUPP, {}));
  if (has_controller && !now.bitrate && !wish.bitrate)
    return fail(
        Errc::usage, message("{} has no bitrate yet", as_it_is(name)),
        message("`bus up {0} --bitrate 500k`, with the bitrate of the drives; where nobody knows it, `bus "
                "detect {0}` listens for it",
                as_it_is(name)));
  return {};
}

can::LinkChange change_for(const can::LinkState& now, const BusWish& wish) {
  can::LinkChange out;
  out.up = true;
  if (wish.bitrate || wish.sample_point) {
    out.bitrate = wish.bitrate ? wish.bitrate : now.bitrate;
    // A sample point stays with the bitrate it was chosen for.
    out.sample_point =
        wish.sample_point || wish.bitrate != now.bitrate ? wish.sample_point : now.sample_point;
  }
  if (wish.restart_ms && wish.restart_ms != now.restart_ms) out.restart_ms = wish.restart_ms;
  if (wish.queue_length && *wish.queue_length != now.queue_length) out.queue_length = wish.queue_length;
  if (now.listen_only) out.listen_only = false;
  return out;
}

bool takes_no_part(const can::LinkState& now) {
  return now.health == can::LinkHealth::bus_off || now.health == can::LinkHealth::stopped;
}

/// The kernel takes a bitrate that its controller misses by 5 %. Nodes of one bus may be 1.58 % apart at the
/// most (ISO 11898-1), which their clocks need.
Result<void> check_bitrate(can::LinkControl& link, const can::LinkChange& step) {
  constexpr double kMostMissed = 0.01;
  const auto now = link.state();
  if (!now) return fail(now.error());
  const double wanted = step.bitrate.value_or(0);
  if (!now->bitrate || std::abs(*now->bitrate - wanted) <= wanted * kMostMissed) return {};
  auto error = can::link_refusal(link.name(), step, *now, EDOM, {});
  error.hint = message("the nearest that it has is {} bit/s", *now->bitrate);
  return fail(std::move(error));
}

}  // namespace

std::string settings_text(const can::LinkState& state) {
  if (!state.bitrate) return {};
  auto out = drive::bitrate_text(*state.bitrate);
  if (state.sample_point) out += ", sample point " + sample_point_text(*state.sample_point);
  return out;
}

Result<BusPlan> plan_bus_up(const std::string& name, const can::LinkState& now, const BusWish& wish) {
  if (const auto possible = check_wish(name, now, wish); !possible) return fail(possible.error());
  BusPlan out;
  if (!now.up) {
    out.steps.push_back(change_for(now, wish));
    return out;
  }
  out.differs = differences(now, wish);
  const bool dead = takes_no_part(now);
  if (dead) out.differs.push_back(formatted("{} is {}", name, can::name(*now.health)));
  if (!out.differs.empty()) {
    out.stops_bus = !dead;
    out.steps.push_back({.up = false});
    out.steps.push_back(change_for(now, wish));
  } else if (wish.queue_length && *wish.queue_length != now.queue_length) {
    out.steps.push_back({.queue_length = wish.queue_length});
  }
  return out;
}

Result<void> set_up(can::LinkControl& link, const can::LinkState& before, const BusPlan& plan) {
  can::LinkKeeper keeper(link, before);
  bool was_down = false;
  for (const auto& step : plan.steps) {
    auto done = link.change(step);
    if (done && step.bitrate) done = check_bitrate(link, step);
    was_down = was_down || step.up == false;
    if (done) continue;
    // A message that is refused may have been carried out in part.
    const auto back = keeper.put_back();
    auto error = done.error();
    if (!back && was_down)
      error.message += message("; {} could not be put back either, and is down", as_it_is(link.name()));
    else if (was_down)
      error.message +=
          message("; {} is up again as before, at {}", as_it_is(link.name()), settings_text(before));
    return fail(std::move(error));
  }
  keeper.keep();
  return {};
}

std::vector<std::string> rounded(const can::LinkState& now, const BusWish& wish) {
  std::vector<std::string> out;
  if (wish.bitrate && now.bitrate && *now.bitrate != *wish.bitrate)
    out.push_back(formatted("the controller cannot make {}: it has {} bit/s",
                            drive::bitrate_text(*wish.bitrate), *now.bitrate));
  if (wish.sample_point && now.sample_point && std::abs(int{*now.sample_point} - int{*wish.sample_point}) > 1)
    out.push_back(formatted("the controller cannot have its sample point at {}: it is at {}",
                            sample_point_text(*wish.sample_point), sample_point_text(*now.sample_point)));
  return out;
}

}  // namespace servoctl::session
