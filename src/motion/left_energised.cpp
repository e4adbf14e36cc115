#include "motion/left_energised.hpp"

#include <fmt/format.h>
#include <set>

#include "motion/power.hpp"

namespace servoctl::motion {

std::string energised_notice(const session::Session& session, std::uint8_t node) {
  if (session.network().must_go_on())
    return fmt::format("node {} IS ENERGISED as long as servoctl runs, and not supervised", node);
  return fmt::format("node {} IS ENERGISED and not supervised; `disable -n {}` de-energises it", node, node);
}

std::string disabled_notice(std::uint8_t node) {
  return fmt::format("node {} was still energised; it has been stopped and disabled", node);
}

std::string power_warning(std::uint8_t node, std::string_view why) {
  return fmt::format("NODE {} MAY STILL BE ENERGISED: SWITCH OFF THE SUPPLY: {}", node, why);
}

void tell_left_energised(show::Desk& desk) {
  const drive::Profile plain;
  for (const auto node : std::set(desk.session->energised().nodes())) {
    Power power(*desk.session, plain, node);
    const auto state = power.state();
    if (state && drive::is_energised(*state))
      desk.notices.push_back(energised_notice(*desk.session, node));
    else if (state && desk.session->energised().contains(node))
      desk.notices.push_back(fmt::format(
          "node {} left \"operation enabled\" by itself ({}) and may restart by itself: 6040h may still hold "
          "\"enable operation\"; `disable -n {}` clears it",
          node, drive::name(*state), node));
    else if (!state && state.error().code != Errc::sdo_abort)
      desk.notices.push_back(
          fmt::format("node {} MAY BE ENERGISED: state not known ({})", node, state.error().message));
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
