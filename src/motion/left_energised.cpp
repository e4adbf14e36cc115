#include "motion/left_energised.hpp"

#include <set>

#include "base/format.hpp"
#include "motion/power.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {

std::string energised_notice(const session::Session& session, std::uint8_t node) {
  if (session.network().must_go_on())
    return formatted("node {} IS ENERGISED as long as servoctl runs, and not supervised", node);
  return formatted("node {} IS ENERGISED and not supervised; `disable -n {}` de-energises it", node, node);
}

Message disabled_notice(std::uint8_t node) {
  return message("node {} was still energised; it has been stopped and disabled", node_name(node));
}

Error ended_in_fault(std::uint8_t node) {
  return drive_error(Errc::negative, node,
                     message("it had been enabled; it is de-energised now, but in fault, and may not have "
                             "obeyed the stop: `fault show -n {}` shows the fault",
                             node_name(node)),
                     "find the cause of the fault before the drive is enabled again");
}

Message power_warning(std::uint8_t node, const Message& why) {
  return message("NODE {} MAY STILL BE ENERGISED: SWITCH OFF THE SUPPLY: {}", node, why);
}

namespace {

/// Longest wait for a drive that was told to be energised a moment ago.
constexpr Duration kPatience = std::chrono::milliseconds(100);
constexpr Duration kPause = std::chrono::milliseconds(5);

/// What the drive is in, once it is energised or the patience has ended. One that did not answer before is
/// not asked again.
Result<drive::DriveState> settled_state(show::Desk& desk, std::uint8_t node) {
  auto& session = *desk.session;
  for (const auto& error : desk.errors)
    if (error.node == node && error.code == Errc::timeout) return fail(Errc::timeout, "it did not answer");
  const drive::Profile plain;
  const auto end = session.now() + kPatience;
  for (;;) {
    auto state = Power(session, plain, node).state();
    const bool may_come = state && !drive::is_energised(*state) && session.energised().contains(node);
    if (!may_come || session.now() >= end || !pause(session, kPause)) return state;
  }
}

}  // namespace

void tell_left_energised(show::Desk& desk, const std::set<std::uint8_t>& nodes) {
  if (nodes.empty()) return;
  auto& session = *desk.session;
  const session::Deaf deaf(session);
  for (const auto node : nodes) {
    const auto state = settled_state(desk, node);
    if (state && drive::is_energised(*state)) {
      desk.notices.push_back(energised_notice(session, node));
    } else if (state && session.energised().contains(node)) {
      desk.notices.push_back(message(
          "node {} is in {}, and 6040h may still hold \"enable operation\": it may become energised by "
          "itself; `disable -n {}` clears it",
          node_name(node), drive::name(*state), node_name(node)));
    } else if (!state && state.error().code != Errc::sdo_abort) {
      auto error = state.error();
      error.message =
          message("node {} MAY BE ENERGISED: state not known ({})", node_name(node), state.error().message);
      error.node = node;
      desk.errors.push_back(std::move(error));
    }
  }
}

void stop_left_energised(show::Desk& desk) {
  for (const auto& [node, done, in_fault] : de_energise(*desk.session)) {
    if (in_fault) {
      desk.errors.push_back(ended_in_fault(node));
      continue;
    }
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
