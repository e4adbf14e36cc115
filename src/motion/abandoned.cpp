#include "motion/abandoned.hpp"

#include <fmt/format.h>
#include <vector>

#include "motion/left_energised.hpp"
#include "motion/power.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {
namespace {

bool is_at_rest(session::Session& session, std::uint8_t node) {
  const drive::Profile plain;
  // What has no power and does not ask for it is forgotten there.
  const auto state = Power(session, plain, node).state();
  return state && !drive::is_energised(*state) && !session.energised().contains(node);
}

}  // namespace

void stop_abandoned(show::Desk& desk, const std::set<std::uint8_t>& nodes) {
  auto& session = *desk.session;
  const auto hold = session.protect(session::Care::guarded);
  const session::Deaf deaf(session);
  std::vector<PowerDownPlan> plans;
  std::vector<std::uint8_t> stopped;
  for (const auto node : nodes) {
    if (is_at_rest(session, node)) continue;
    desk.tell(fmt::format(
        "warning: node {} has power or does not tell, and the client that enabled it is gone: stopping it\n",
        node));
    plans.emplace_back();
    plans.back().node = node;
    plans.back().aim = PowerAim::stop_and_disable;
    stopped.push_back(node);
  }
  const auto done = take_down(session, std::move(plans));
  for (std::size_t i = 0; i < done.size(); ++i) {
    if (done[i].outcome) {
      desk.tell("notice: " + disabled_notice(stopped[i]) + "\n");
      continue;
    }
    auto error = done[i].outcome.error();
    error.message = power_warning(stopped[i], error.message);
    desk.errors.push_back(std::move(error));
  }
}

}  // namespace servoctl::motion
