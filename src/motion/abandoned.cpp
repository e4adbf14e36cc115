#include "motion/abandoned.hpp"

#include <utility>
#include <vector>

#include "base/format.hpp"
#include "drive/enabling_write.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "motion/left_energised.hpp"
#include "motion/power.hpp"
#include "od/encoding.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {
namespace {

bool is_at_rest(session::Session& session, std::uint8_t node) {
  const drive::Profile plain;
  // What has no power and does not ask for it is forgotten there.
  const auto state = Power(session, plain, node).state();
  return state && !drive::is_energised(*state) && !session.energised().contains(node);
}

void end_power(show::Desk& desk, std::uint8_t node, const drive::PowerParameter& parameter) {
  const auto place = drive::place_of(*desk.profile, parameter.end);
  if (!place) return;
  const auto meaning = drive::meaning(drive::target_at(desk.profile, *place), node);
  const auto data = od::encode(meaning.type, od::Value(parameter.value));
  const auto done = data ? desk.session->download(node, *place, *data) : Result<void>(fail(data.error()));
  if (done)
    return desk.tell(formatted(
        "notice: node {}: {} = {} is written: the client that wrote {} is gone, or the gateway ends\n", node,
        parameter.end, parameter.value, parameter.name));
  auto error = done.error();
  error.message = power_warning(node, error.message);
  desk.errors.push_back(std::move(error));
}

}  // namespace

bool PowerWrites::note(const drive::Profile* profile, std::uint8_t node, ObjectAddress object,
                       ByteSpan data) {
  const auto* parameter = drive::power_parameter(profile, object, data);
  if (parameter != nullptr) names_[node].insert(parameter->name);
  return parameter != nullptr;
}

void PowerWrites::end(show::Desk& desk, const std::set<std::uint8_t>& nodes) {
  if (desk.profile == nullptr) return;
  const session::Deaf deaf(*desk.session);
  for (const auto node : nodes) {
    const auto names = std::exchange(names_[node], {});
    for (const auto& parameter : desk.profile->rules.motion.without_controlword)
      if (names.count(parameter.name) != 0) end_power(desk, node, parameter);
  }
}

void stop_abandoned(show::Desk& desk, const std::set<std::uint8_t>& nodes) {
  auto& session = *desk.session;
  const auto hold = session.protect(session::Care::guarded);
  const session::Deaf deaf(session);
  std::set<std::uint8_t> stopped;
  for (const auto node : nodes) {
    if (is_at_rest(session, node)) continue;
    desk.tell(formatted(
        "warning: node {} is energised or does not report its state, and the client that enabled it is gone: stopping it\n",
        node));
    stopped.insert(node);
  }
  for (const auto& [node, done, in_fault] : de_energise(session, stopped)) {
    if (in_fault) {
      desk.errors.push_back(ended_in_fault(node));
      continue;
    }
    if (done) {
      desk.tell("notice: " + disabled_notice(node).text() + "\n");
      continue;
    }
    auto error = done.error();
    error.message = power_warning(node, error.message);
    desk.errors.push_back(std::move(error));
  }
}

}  // namespace servoctl::motion
