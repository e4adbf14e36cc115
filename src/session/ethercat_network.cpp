#include "session/ethercat_network.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "ethercat/request_sequence.hpp"
#include "ethercat/sm_watchdog.hpp"
#include "session/ethercat_exchange.hpp"
#include "session/ethercat_object_channel.hpp"
#include "session/ethercat_values.hpp"

namespace servoctl::session {
namespace {

using ethercat::AlState;

/// Emergencies that are kept of each node.
constexpr std::size_t kKeptEmergencies = 8;
/// Between two tries to find the slaves of a ring that was lost.
constexpr Duration kRecoverPause = std::chrono::milliseconds(10);

std::optional<AlState> al_state(NodeState state) {
  switch (state) {
    case NodeState::initialising: return AlState::init;
    case NodeState::pre_operational: return AlState::preop;
    case NodeState::safe_operational: return AlState::safeop;
    case NodeState::operational: return AlState::op;
    case NodeState::bootstrap:
    case NodeState::stopped:
    case NodeState::unknown: break;
  }
  return std::nullopt;
}

}  // namespace

NodeState node_state(AlState state) {
  switch (state) {
    case AlState::init: return NodeState::initialising;
    case AlState::preop: return NodeState::pre_operational;
    case AlState::boot: return NodeState::bootstrap;
    case AlState::safeop: return NodeState::safe_operational;
    case AlState::op: return NodeState::operational;
    case AlState::none: break;
  }
  return NodeState::unknown;
}

std::string_view EtherCatNetwork::state_word(NodeState state) const {
  if (state == NodeState::bootstrap) return ethercat::name(AlState::boot);
  const auto al = al_state(state);
  return al ? ethercat::name(*al) : name(state);
}

EtherCatNetwork::EtherCatNetwork(std::unique_ptr<ethernet::Port> port, std::string url)
    : url_(std::move(url)), wire_(std::move(port), *this) {}

Result<void> EtherCatNetwork::close() {
  wire_.set_cancelled({});
  Result<void> out;
  for (const auto* node : known_)
    if (auto ended = end_exchange(node->number); !ended && out) out = std::move(ended);
  wire_.port().end_trace();
  return out;
}

void EtherCatNetwork::set_raised(EtherCatNode& node, bool raised) {
  if (node.raised == raised) return;
  node.raised = raised;
  const bool any = std::any_of(known_.begin(), known_.end(), [](const auto* one) { return one->raised; });
  if (any && care_.is_held()) return;
  care_ = any ? Protection::Hold(protection_, Care::unsettled) : Protection::Hold();
}

EtherCatNode& EtherCatNetwork::of(std::uint8_t node) {
  auto& place = nodes_[node & 0x7FU];
  if (!place) {
    place = std::make_unique<EtherCatNode>(node);
    known_.push_back(place.get());
  }
  return *place;
}

Result<bool> EtherCatNetwork::step(TimePoint deadline) {
  auto stepped = wire_.step(deadline);
  // Whoever waits for an answer may wait for a cable that is not plugged in.
  constexpr unsigned kMostLost = 3;
  if (stepped && watching_.lost >= kMostLost && !wire_.port().has_link()) {
    watching_.lost = 0;
    return fail(nothing_back());
  }
  return stepped;
}

Result<void> EtherCatNetwork::recover(TimePoint deadline) {
  for (;;) {
    if (auto back = wire_.port().recover(deadline); !back) return back;
    auto there = count_slaves();
    if (there || there.error().code != Errc::bus || now() >= deadline) return there;
    // What it was lost by is told when the next frame is not taken.
    (void)wire_.step(std::min(deadline, now() + kRecoverPause));
  }
}

void EtherCatNetwork::serve(ethercat::Ring& ring, TimePoint now) {
  for (auto* node : known_) serve_node(*node, ring, now);
  watch(ring, now);
}

void EtherCatNetwork::serve_node(EtherCatNode& node, ethercat::Ring& ring, TimePoint now) {
  if (node.image) node.image->serve(ring, now);
  for (auto* listener : node.listeners) listener->note();
  if (node.image && node.clock) node.clock->serve(ring, *node.image);
  if (!node.coe) return;
  if (node.coe->deadline() <= now) node.coe->on_time(now);
  node.coe->serve(ring, now);
  if (node.owner != nullptr && !node.coe->client().busy()) node.owner->stir();
  // Of a transfer whose owner has gone.
  if (node.owner == nullptr) (void)node.coe->client().take_result();
  take_emergencies(node, now);
}

void EtherCatNetwork::take_emergencies(EtherCatNode& node, TimePoint now) {
  while (const auto emergency = node.coe->mailbox().take_emergency()) {
    if (emergency->is_reset()) node.emergencies.clear();
    if (!emergency->is_reset()) node.emergencies.push_back(*emergency), ++node.alarms;
    if (node.emergencies.size() > kKeptEmergencies) node.emergencies.pop_front();
    tell(node.number, *emergency, now);
  }
}

TimePoint EtherCatNetwork::deadline() const {
  auto out = watching_.count ? kNever : watching_.next;
  for (const auto* node : known_) {
    if (node->image) out = std::min(out, node->image->deadline());
    if (node->coe) out = std::min(out, node->coe->deadline());
  }
  return out;
}

std::unique_ptr<ObjectChannel> EtherCatNetwork::object_channel(std::uint8_t node, Duration timeout) {
  return std::make_unique<EtherCatObjectChannel>(*this, of(node), timeout);
}

void EtherCatNetwork::tell(std::uint8_t node, NodeEvent::What what, TimePoint now) {
  events_.push_back({now, node, std::move(what)});
}

std::optional<NodeEvent> EtherCatNetwork::take_event() {
  if (events_.empty()) return std::nullopt;
  auto out = std::move(events_.front());
  events_.pop_front();
  return out;
}

Result<void> EtherCatNetwork::request_state(std::uint8_t number, NodeState state) {
  const auto target = al_state(state);
  if (!target)
    return fail(drive_error(Errc::usage, number, message("EtherCAT has no state {}", name(state)),
                            "use init, preop, safeop or op"));
  auto& node = of(number);
  if (*target != AlState::op) node.kept = false;
  if (*target == AlState::safeop || *target == AlState::op)
    return EtherCatExchange(*this, node).begin(*target);
  // INIT is the way out of a mailbox that is of no use, and of BOOT, from which nothing leads to PRE-OP.
  if (auto ended = end_exchange(number); !ended && *target != AlState::init) return ended;
  const auto ready = *target == AlState::init ? approach(node) : prepare(node);
  if (!ready) return ready;
  if (const auto there = go_to(node, *target); !there) return fail(there.error());
  if (*target == AlState::init)
    forget_mailbox(node, drive_error(Errc::negative, number, "it was told to enter INIT"));
  return {};
}

Result<void> EtherCatNetwork::ask_state(std::uint8_t node) {
  auto& asked = of(node);
  if (const auto ready = prepare(asked); !ready) return ready;
  watching_.next = now();
  return wire_.flush(now());
}

bool EtherCatNetwork::must_go_on() const {
  return std::any_of(known_.begin(), known_.end(), [](const auto* node) { return node->exchanges(); });
}

Result<void> EtherCatNetwork::arm_watchdog(std::uint8_t node, const LifeSign& sign) {
  if (!carries(sign.kind))
    return fail(drive_error(Errc::usage, node, "there is no such watchdog on EtherCAT"));
  if (const auto possible = ethercat::sm_watchdog(sign.period); !possible) return fail(possible.error());
  of(node).watchdog = sign.period;
  return {};
}

/// Its outputs end without a word: what is left of the drive is its watchdog's.
void EtherCatNetwork::disarm_watchdog(std::uint8_t node) {
  auto* known = find(node);
  if (known != nullptr && known->exchanges()) end_cycles(*known);
}

Result<void> EtherCatNetwork::end_exchange(std::uint8_t node) {
  auto* known = find(node);
  if (known == nullptr || !known->raised) return {};
  return EtherCatExchange(*this, *known).end();
}

bool EtherCatNetwork::stays_operational(std::uint8_t node) const {
  const auto* known = find(node);
  return known != nullptr && known->kept;
}

void EtherCatNetwork::send_last_word(std::uint8_t node, ObjectAddress object, std::uint16_t value) noexcept {
  try {
    auto* known = find(node);
    if (known == nullptr || !known->exchanges()) return;
    const std::array<std::uint8_t, 2> data{static_cast<std::uint8_t>(value & 0xFFU),
                                           static_cast<std::uint8_t>(value >> 8U)};
    if (!known->image->set(node, object, data)) return;
    const auto end = now() + 2 * known->image->options().cycle;
    while (now() < end && wire_.step(end)) {
    }
  } catch (...) {
    return;
  }
}

std::unique_ptr<ProcessValues> EtherCatNetwork::process_values(std::uint8_t node,
                                                               std::span<const ObjectAddress> objects) {
  return std::make_unique<EtherCatValues>(of(node), objects);
}

std::vector<Message> EtherCatNetwork::take_notices() {
  auto out = std::exchange(notices_, {});
  for (auto& notice : wire_.port().take_notices()) out.push_back(std::move(notice));
  return out;
}

std::string EtherCatNetwork::silence_hint(std::uint8_t node) const {
  if (!wire_.port().has_link()) return formatted("{} has no link: is the cable plugged in?", url_);
  return formatted(
      "is node {} powered, and are the cables on the way to it plugged in? `scan` shows which "
      "slaves answer",
      node);
}

std::string EtherCatNetwork::state_command(std::uint8_t node, NodeState state) const {
  const auto target = al_state(state).value_or(AlState::preop);
  constexpr std::array<std::string_view, 4> kWords{"init", "preop", "safeop", "op"};
  const std::size_t at = target == AlState::init     ? 0
                         : target == AlState::safeop ? 2
                         : target == AlState::op     ? 3
                                                     : 1;
  return formatted("state {} -n {}", kWords[at], node);
}

const ethercat::ProcessImage* EtherCatNetwork::image_of(std::uint8_t node) const {
  const auto* known = find(node);
  return known != nullptr && known->exchanges() ? known->image.get() : nullptr;
}

const ethercat::AlStatus* EtherCatNetwork::al_of(std::uint8_t node) const {
  const auto* known = find(node);
  return known != nullptr && known->al ? &*known->al : nullptr;
}

std::optional<NodeState> EtherCatNetwork::Records::state(std::uint8_t node) const {
  const auto* known = network_->find(node);
  return known != nullptr && known->al ? std::optional(node_state(known->al->state)) : std::nullopt;
}

std::uint32_t EtherCatNetwork::Records::boots(std::uint8_t node) const {
  const auto* known = network_->find(node);
  return known != nullptr ? known->boots : 0;
}

std::uint32_t EtherCatNetwork::Records::heartbeats(std::uint8_t node) const {
  const auto* known = network_->find(node);
  return known != nullptr ? known->reports : 0;
}

const std::deque<canopen::Emergency>& EtherCatNetwork::Records::emergencies(std::uint8_t node) const {
  static const std::deque<canopen::Emergency> kNone;
  const auto* known = network_->find(node);
  return known != nullptr ? known->emergencies : kNone;
}

std::uint32_t EtherCatNetwork::Records::alarms(std::uint8_t node) const {
  const auto* known = network_->find(node);
  return known != nullptr ? known->alarms : 0;
}

}  // namespace servoctl::session
