#include "session/process_values.hpp"

#include <algorithm>

#include "session/can_network.hpp"
#include "session/pdo_setup.hpp"

namespace servoctl::session {

std::unique_ptr<ProcessValues> process_values(Session& session, const drive::Profile* profile,
                                              std::uint8_t node, std::span<const ObjectAddress> objects) {
  const std::uint8_t nodes[] = {node};
  learn_pdos(session, profile, nodes);
  return session.network().process_values(node, objects);
}

bool learn_pdos(Session& session, const drive::Profile* profile, std::span<const std::uint8_t> nodes) {
  if (session.can() == nullptr) return true;
  const auto answers = read_pdo_values(session, profile, nodes);
  return std::all_of(answers.begin(), answers.end(), [](const auto& answer) { return answer.has_value(); });
}

Lifetime::Lifetime(Session& session, std::uint8_t node)
    : session_(&session), node_(node), learned_(epoch()), seen_(learned_) {}

canopen::NodeEpoch Lifetime::epoch() const {
  if (const auto* can = session_->can()) return can->epoch(node_);
  canopen::NodeEpoch out;
  out.boots = session_->watch().boots(node_);
  return out;
}

std::string Lifetime::ended() const { return canopen::reason_between(learned_, epoch()); }

bool Lifetime::is_to_renew() {
  if (const auto now = epoch(); now != seen_) {
    seen_ = now;
    due_ = session_->now() + kSettling;
  }
  if (session_->now() < due_) return false;
  due_ = session_->now() + kAgain;
  return true;
}

}  // namespace servoctl::session
