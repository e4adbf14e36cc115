#include "traffic/node_source.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/format.hpp"
#include "session/identify.hpp"
#include "traffic/listening.hpp"

namespace servoctl::traffic {

NodeSource::NodeSource(show::Desk& desk, std::uint8_t node, std::vector<ObjectAddress> objects,
                       const session::Lifetime& lifetime)
    : desk_(&desk), node_(node), objects_(std::move(objects)), lifetime_(lifetime) {
  auto& session = *desk.session;
  if (const auto* known = session.identities().find(node, session.watch().boots(node))) identity_ = *known;
  hear();
}

void NodeSource::hear() {
  values_ = desk_->session->network().process_values(node_, objects_);
  values_->keep_all();
  carried_ =
      std::any_of(objects_.begin(), objects_.end(), [&](auto object) { return values_->carries(object); });
}

std::vector<session::ProcessValues::Arrival> NodeSource::take_all() {
  auto out = std::exchange(arrivals_, {});
  auto more = values_->take_all();
  std::move(more.begin(), more.end(), std::back_inserter(out));
  return out;
}

bool NodeSource::renew() {
  auto& session = *desk_->session;
  const auto why = lifetime_.ended();
  if (why.empty()) return false;
  if (!std::exchange(ended_, true)) tell_end(why);
  if (!lifetime_.is_to_renew()) return false;
  const session::Lifetime lifetime(session, node_);
  const std::uint8_t nodes[] = {node_};
  if (!session::learn_pdos(session, desk_->profile, nodes)) return false;
  arrivals_ = take_all();
  lifetime_ = lifetime;
  ended_ = false;
  hear();
  tell_renewal();
  check_identity();
  return true;
}

void NodeSource::tell_end(const std::string& why) {
  if (carried_)
    tell_now(*desk_,
             formatted("node {} {}: its values are read by SDO until its PDO mapping has been read again",
                       node_, why));
}

void NodeSource::tell_renewal() {
  if (carried_)
    tell_now(*desk_, formatted("node {}: its PDO mapping was read again, and its TPDOs are used", node_));
}

/// Another drive may have been connected meanwhile.
void NodeSource::check_identity() {
  if (!identity_ || desk_->profile == nullptr) return;
  const std::uint8_t nodes[] = {node_};
  const auto now = session::identify(*desk_->session, nodes, desk_->profile->rules).front();
  if (!now) return;
  auto change = session::different_number(*identity_, *now);
  const bool both_named = !now->device_name.empty() && !identity_->device_name.empty();
  if (change.empty() && both_named && now->device_name != identity_->device_name) change = "its name (1008h)";
  if (change.empty()) return;
  tell_now(*desk_,
           formatted("node {} is a different drive now ({} differs): end this command and start it again",
                     node_, change));
  identity_ = *now;
}

}  // namespace servoctl::traffic
