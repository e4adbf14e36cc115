#include "motion/left_energised.hpp"

#include <fmt/format.h>
#include <set>

#include "motion/power.hpp"

namespace servoctl::motion {

std::string energised_notice(std::uint8_t node) {
  return fmt::format("node {} IS ENERGISED and nothing watches over it; `disable -n {}` takes the power away",
                     node, node);
}

std::string disabled_notice(std::uint8_t node) {
  return fmt::format("node {} was left energised; it is stopped and disabled now", node);
}

std::string power_warning(std::uint8_t node, std::string_view why) {
  return fmt::format("NODE {} MAY STILL BE ENERGISED: TAKE THE POWER AWAY: {}", node, why);
}

void tell_left_energised(show::Desk& desk) {
  const drive::Profile plain;
  for (const auto node : std::set(desk.session->energised().nodes())) {
    Power power(*desk.session, plain, node);
    const auto state = power.state();
    if (state && drive::is_energised(*state))
      desk.notices.push_back(energised_notice(node));
    else if (state && desk.session->energised().contains(node))
      desk.notices.push_back(fmt::format(
          "node {} has lost its power by itself ({}) and may start again by itself: 6040h still says "
          "\"enable operation\"; `disable -n {}` takes that back",
          node, drive::name(*state), node));
    else if (!state && state.error().code != Errc::sdo_abort)
      desk.notices.push_back(
          fmt::format("node {} MAY BE ENERGISED: it does not tell ({})", node, state.error().message));
  }
}

void stop_left_energised(show::Desk& desk) {
  for (const auto& [node, done] : de_energise(*desk.session)) {
    if (done) {
      desk.notices.push_back(disabled_notice(node));
      continue;
    }
    auto error = done.error();
    error.message = power_warning(node, error.message);
    desk.errors.push_back(std::move(error));
  }
}

}  // namespace servoctl::motion
