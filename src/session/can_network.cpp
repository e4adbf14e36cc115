#include "session/can_network.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/nmt.hpp"
#include "session/can_object_channel.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {
namespace {

/// So many damaged frames are no accident.
constexpr std::size_t kNoAccident = 3;
/// Of one who does not answer: errors that are longer ago are not the reason.
constexpr Duration kMeanwhile = std::chrono::seconds(5);

using canopen::NmtCommand;
using canopen::NmtState;

/// The words of every network for what a CANopen machine noticed.
struct InCommon {
  NodeEvent::What operator()(canopen::NodeEvent::BootUp) const { return NodeEvent::BootUp{}; }
  NodeEvent::What operator()(canopen::NodeEvent::StateChange change) const {
    return NodeEvent::StateChange{node_state(change.state)};
  }
  NodeEvent::What operator()(canopen::NodeEvent::HeartbeatLost lost) const {
    return NodeEvent::Gone{lost.silence, NodeEvent::Gone::Sign::heartbeat};
  }
  NodeEvent::What operator()(const canopen::Emergency& emergency) const { return emergency; }
  NodeEvent::What operator()(canopen::NodeEvent::GuardingLost lost) const {
    return NodeEvent::Gone{
        lost.silence, lost.wrong_toggle ? NodeEvent::Gone::Sign::toggle : NodeEvent::Gone::Sign::guarding};
  }
  NodeEvent::What operator()(canopen::NodeEvent::GuardingBack back) const {
    return NodeEvent::Back{node_state(back.state)};
  }
  NodeEvent::What operator()(const canopen::NodeEvent::Doubled& doubled) const {
    return NodeEvent::Doubled{doubled.by};
  }
};

}  // namespace

NodeState node_state(NmtState state) {
  switch (state) {
    case NmtState::initialising: return NodeState::initialising;
    case NmtState::stopped: return NodeState::stopped;
    case NmtState::operational: return NodeState::operational;
    case NmtState::pre_operational: return NodeState::pre_operational;
  }
  return NodeState::unknown;
}

std::optional<NmtCommand> nmt_command(NodeState state) {
  switch (state) {
    case NodeState::stopped: return NmtCommand::stop;
    case NodeState::pre_operational: return NmtCommand::enter_pre_operational;
    case NodeState::operational: return NmtCommand::start;
    case NodeState::unknown:
    case NodeState::initialising:
    case NodeState::bootstrap:
    case NodeState::safe_operational: break;
  }
  return std::nullopt;
}

can::Frame frame_of(const LifeSign& sign, std::uint8_t node) {
  return sign.kind == LifeSign::Kind::heartbeat
             ? canopen::heartbeat_frame(sign.producer, NmtState::operational)
             : canopen::guarding_request(node);
}

CanNetwork::CanNetwork(std::unique_ptr<can::Bus> bus, std::string url)
    : bus_(std::move(bus)), url_(std::move(url)) {}

CanNetwork::~CanNetwork() = default;

std::optional<NodeState> CanNetwork::Records::state(std::uint8_t node) const {
  const auto state = guard_->is_lost(node) ? std::nullopt : watch_->state(node);
  return state ? std::optional(node_state(*state)) : std::nullopt;
}

Result<bool> CanNetwork::step(TimePoint deadline) {
  frame_.reset();
  while (const auto question = guard_.take_frame())
    if (const auto sent = bus_->send(*question); !sent) return fail(sent.error());
  const auto heartbeat = send_heartbeat();
  if (!heartbeat) return fail(heartbeat.error());
  const auto sync = send_sync();
  if (!sync) return fail(sync.error());
  auto frame = bus_->receive(std::min({deadline, watch_.deadline(), guard_.deadline(), *heartbeat, *sync}));
  if (!frame) return fail(std::move(frame.error()));
  frame_ = *frame;
  stepped_at_ = frame_ ? std::max(stepped_at_, bus_->arrived()) : now();
  // What the kernel tells of the wire has no identifier of a node.
  const bool is_message = frame_ && !frame_->error;
  if (is_message) hear(*frame_);
  watch_.on_time(stepped_at_);
  guard_.on_time(stepped_at_);
  if (!frame_) return false;
  if (is_message) dispatch(*frame_);
  if (is_message) return true;
  if (const auto error = can::parse_wire_error(*frame_)) {
    wire_errors_.add(*error);
    wire_error_at_ = stepped_at_;
  }
  if (const auto report = can::parse_report(*frame_))
    if (const auto alive = on_report(*report); !alive) return fail(alive.error());
  return true;
}

Result<void> CanNetwork::recover(TimePoint deadline) {
  if (auto back = bus_->recover(deadline); !back) return back;
  watch_.on_gap(now());
  epochs_.on_gap();  // Whoever is there now may be another.
  lss_selection_.reset();
  return {};
}

void CanNetwork::hear(const can::Frame& frame) {
  watch_.on_frame(frame, stepped_at_);
  duplicates_.on_frame(frame, stepped_at_);
  guard_.on_frame(frame, stepped_at_);
  epochs_.on_frame(frame);
  if (sync_ && !frame.extended && frame.id == sync_->options.can_id) ++sync_->foreign;
  // By index: who hears may begin or end to listen.
  for (std::size_t i = 0; i < listeners_.size(); ++i) (*listeners_[i])(frame, stepped_at_);
}

void CanNetwork::dispatch(const can::Frame& frame) {
  if (frame.extended || frame.id < canopen::kSdoAnswer ||
      frame.id > canopen::kErrorControl + canopen::kLastNode)
    return;
  for (auto* channel = channels_[frame.id & 0x7FU]; channel != nullptr; channel = channel->next_)
    channel->on_frame(frame, stepped_at_);
}

Result<void> CanNetwork::on_report(can::ControllerReport report) {
  if (report == can::ControllerReport::bus_off) {
    last_report_.reset();
    const auto name = canonical_url(url_);
    return fail(
        Errc::bus, message("{}: {}", as_it_is(url_), can::text(report)),
        name.find(':') == std::string::npos
            ? message("check bitrate, wiring and termination; then `bus up {}` takes it down and up again "
                      "(with `--restart-ms 100` it comes back by itself)",
                      as_it_is(name))
            : "check bitrate, wiring and termination; the next command opens the adapter anew");
  }
  if (report != last_report_) reports_.push_back(report);
  last_report_ = report;
  return {};
}

std::vector<Message> CanNetwork::take_notices() {
  std::vector<Message> out;
  for (const auto report : take_reports())
    out.push_back(message("{}: {}", as_it_is(url_), can::text(report)));
  for (auto& notice : bus_->take_notices()) out.push_back(std::move(notice));
  for (auto& notice : std::exchange(habit_notices_, {})) out.push_back(std::move(notice));
  return out;
}

void CanNetwork::tell_habit(std::uint8_t node, canopen::SdoHabit habit) {
  if (told_habits_.emplace(node, habit).second)
    habit_notices_.push_back(message("node {}: {}", node_name(node), canopen::text(habit)));
}

std::string CanNetwork::silence_hint(std::uint8_t node) const {
  const auto start = state_command(node, NodeState::pre_operational);
  if (records_.state(node) == NodeState::stopped)
    return formatted("node {} is stopped (NMT, by its heartbeat) and cannot answer SDO: `{}`", node, start);
  if (wire_errors_.damage() >= kNoAccident && now() < wire_error_at_ + kMeanwhile)
    return formatted(
        "there were errors on the wire ({}): another bitrate, wiring or termination? `doctor {}` tells them apart",
        wire_errors_.text(), canonical_url(url_));
  return formatted(
      "is node {} powered, connected, at this bitrate and node-ID? `scan` shows which nodes answer; a "
      "stopped node does not: `{}`",
      node, start);
}

std::string CanNetwork::state_order(NodeState state) const {
  return state == NodeState::operational ? "NMT \"start\""
         : state == NodeState::stopped   ? "NMT \"stop\""
                                         : "NMT \"enter pre-operational\"";
}

std::string CanNetwork::state_command(std::uint8_t node, NodeState state) const {
  const auto* word = state == NodeState::operational ? "start"
                     : state == NodeState::stopped   ? "stop"
                                                     : "preop";
  return formatted("nmt {} -n {}", word, node);
}

std::unique_ptr<ObjectChannel> CanNetwork::object_channel(std::uint8_t node, Duration timeout) {
  return std::make_unique<CanObjectChannel>(*this, node, timeout);
}

/// What the three have noticed since it was asked last, in the order of time.
std::optional<NodeEvent> CanNetwork::take_event() {
  if (events_.empty()) {
    const auto add = [&](const canopen::NodeEvent& event) {
      events_.push_back({event.time, event.node, std::visit(InCommon{}, event.what), event.times});
    };
    while (const auto event = watch_.take_event()) add(*event);
    while (const auto event = guard_.take_event()) add(*event);
    while (const auto event = duplicates_.take_event()) add(*event);
    std::stable_sort(events_.begin(), events_.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
  }
  if (events_.empty()) return std::nullopt;
  auto out = std::move(events_.front());
  events_.pop_front();
  return out;
}

Result<void> CanNetwork::send(const can::Frame& frame) {
  duplicates_.on_sent(frame, now());
  watch_.on_sent(frame, now());
  epochs_.on_frame(frame);
  const auto sent = bus_->send(frame);
  if (ordered_ && sent)
    if (const auto order = canopen::parse_nmt(frame))
      ordered_(order->node, formatted("NMT \"{}\"", canopen::name(order->command)));
  return sent;
}

Result<void> CanNetwork::request_state(std::uint8_t node, NodeState state) {
  const auto command = nmt_command(state);
  if (!command)
    return fail(Errc::usage, message("no NMT command leads to state {}", name(state)),
                "use operational, pre-operational or stopped");
  return send(canopen::nmt_frame(*command, node));
}

Result<void> CanNetwork::ask_state(std::uint8_t node) { return send(canopen::guarding_request(node)); }

bool CanNetwork::carries(LifeSign::Kind sign) const {
  return sign == LifeSign::Kind::heartbeat ||
         (sign == LifeSign::Kind::guarding && carries_remote_frames(url_));
}

Result<void> CanNetwork::arm_watchdog(std::uint8_t node, const LifeSign& sign) {
  if (sign.kind == LifeSign::Kind::heartbeat)
    produce_heartbeat(sign.producer, sign.period);
  else
    guard(node, {sign.period, sign.life_factor});
  return {};
}

void CanNetwork::disarm_watchdog(std::uint8_t node) {
  stop_heartbeat();
  if (guard_.guards(node)) stop_guarding();
}

void CanNetwork::send_last_word(std::uint8_t node, ObjectAddress object, std::uint16_t value) noexcept {
  // Expedited, two bytes (CiA 301, 7.2.4.3.3).
  can::Frame frame;
  frame.id = static_cast<std::uint32_t>(canopen::kSdoRequest) + node;
  frame.size = 8;
  frame.data = {0x2B,
                static_cast<std::uint8_t>(object.index & 0xFFU),
                static_cast<std::uint8_t>(object.index >> 8U),
                object.sub,
                static_cast<std::uint8_t>(value & 0xFFU),
                static_cast<std::uint8_t>(value >> 8U),
                0,
                0};
  try {
    (void)bus_->send(frame);  // Past what remembers who was asked: that needs memory.
  } catch (...) {
    return;
  }
}

void CanNetwork::guard(std::uint8_t node, canopen::GuardOptions options) {
  watch_.set_guarded(node, true);
  guard_.start(node, options, now());
  guard_.on_time(now());
}

void CanNetwork::stop_guarding() {
  for (std::uint8_t node = canopen::kFirstNode; node <= canopen::kLastNode; ++node) {
    watch_.set_guarded(node, false);
    guard_.stop(node);
  }
}

TimePoint CanNetwork::next_event() const {
  return std::min({bus_->next_event(), watch_.deadline(), guard_.deadline(),
                   heartbeat_ ? heartbeat_->next : kNever, sync_ ? sync_->producer.deadline() : kNever});
}

}  // namespace servoctl::session
