#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/open_requests.hpp"
#include "can/bus.hpp"
#include "can/controller_report.hpp"
#include "can/error_frame.hpp"
#include "canopen/duplicate_watch.hpp"
#include "canopen/lss.hpp"
#include "canopen/node_epoch.hpp"
#include "canopen/node_guard.hpp"
#include "canopen/node_watch.hpp"
#include "canopen/pdo.hpp"
#include "canopen/sdo_habits.hpp"
#include "session/network.hpp"
#include "session/sync_production.hpp"

namespace servoctl::session {

class CanObjectChannel;

/// The state as NodeState has it, and the command that leads there; empty where CANopen has none.
NodeState node_state(canopen::NmtState state);
std::optional<canopen::NmtCommand> nmt_command(NodeState state);
/// What is sent once a period.
can::Frame frame_of(const LifeSign& sign, std::uint8_t node);

/// A CAN bus with CANopen nodes: all that knows frames, COB-IDs and NMT. What is public here beside Network
/// is for what only CAN has, and is reached by Session::can().
class CanNetwork final : public Network {
 public:
  using OnFrame = std::function<void(const can::Frame& frame, TimePoint time)>;

  /// `url` stands in messages.
  CanNetwork(std::unique_ptr<can::Bus> bus, std::string url);
  ~CanNetwork() override;

  TimePoint now() const override { return bus_->now(); }
  /// One frame; the watches see it first, then listeners, then the channel it is for. Errc::bus when the
  /// controller reports bus-off as well.
  Result<bool> step(TimePoint deadline) override;
  TimePoint stepped_at() const override { return stepped_at_; }
  TimePoint next_event() const override;
  TimePoint keep_up() override;
  int poll_fd() const override { return bus_->poll_fd(); }
  Result<void> recover(TimePoint deadline) override;
  std::unique_ptr<ObjectChannel> object_channel(std::uint8_t node, Duration timeout) override;
  const NodeRecords& records() const override { return records_; }
  std::optional<NodeEvent> take_event() override;
  /// NMT: operational, pre-operational and stopped.
  Result<void> request_state(std::uint8_t node, NodeState state) override;
  /// By node guarding: a node that guards its master's life begins to do so.
  Result<void> ask_state(std::uint8_t node) override;
  void doubt_state(std::uint8_t node) override { watch_.on_command(node); }
  /// No guarding where there are no remote frames.
  bool carries(LifeSign::Kind sign) const override;
  Result<void> arm_watchdog(std::uint8_t node, const LifeSign& sign) override;
  void disarm_watchdog(std::uint8_t node) override;
  void send_last_word(std::uint8_t node, ObjectAddress object, std::uint16_t value) noexcept override;
  /// By TPDOs, of those told by learn_pdos().
  std::unique_ptr<ProcessValues> process_values(std::uint8_t node,
                                                std::span<const ObjectAddress> objects) override;
  /// What the controller reported, and what the bus has to say.
  std::vector<Message> take_notices() override;
  void flush_trace() override { bus_->flush_trace(); }
  Result<void> close() override {
    bus_->end_trace();
    return {};
  }
  /// A heartbeat says that a node is stopped; of one that sends none nobody knows.
  std::string_view state_title() const override { return "NMT state"; }
  std::string state_order(NodeState state) const override;
  std::string silence_hint(std::uint8_t node) const override;
  std::string state_command(std::uint8_t node, NodeState state) const override;
  CanNetwork* can() override { return this; }
  void expect_power(std::uint8_t node) override { powered_by_pdo_.insert(node); }
  void end_expecting(std::uint8_t node) override { powered_by_pdo_.erase(node); }
  bool expects_power(std::uint8_t node) const override { return powered_by_pdo_.count(node) > 0; }

  /// Sends a frame of any kind. Errors as can::Bus::send().
  Result<void> send(const can::Frame& frame);
  /// The frame that the last step took in; empty when it took none.
  const std::optional<can::Frame>& frame() const { return frame_; }
  can::Bus& bus() { return *bus_; }
  /// What the controller reported since the last call; the same report in succession is told once.
  std::vector<can::ControllerReport> take_reports() { return std::exchange(reports_, {}); }

  /// What the controller told of errors on the wire since the bus was opened; drivers tell what they can.
  const can::WireErrors& wire_errors() const { return wire_errors_; }

  /// The LSS slave that whoever asks of LSS means when he names none; forgotten with the bus.
  std::optional<canopen::LssAddress>& lss_selection() { return lss_selection_; }

  canopen::NodeWatch& watch() { return watch_; }
  /// Whether two nodes have one number.
  canopen::DuplicateWatch& duplicates() { return duplicates_; }
  /// What may have changed the node so far.
  canopen::NodeEpoch epoch(std::uint8_t node) const;
  /// PDOs of a node as they were read.
  struct KnownPdos {
    std::vector<canopen::Pdo> pdos;
    TimePoint time{};
    canopen::NodeEpoch epoch = {};  ///< They hold as long as this is epoch().
  };
  /// The PDOs that a node has, all of them: process_values() takes their TPDOs for its own. `epoch`: when
  /// their reading began.
  void learn_pdos(std::uint8_t node, std::vector<canopen::Pdo> pdos, const canopen::NodeEpoch& epoch) {
    pdos_[node] = {std::move(pdos), now(), epoch};
  }
  /// What was learned last; null where nothing was, and once it no longer holds.
  const KnownPdos* known_pdos(std::uint8_t node) const;
  void forget_pdos(std::uint8_t node) { pdos_.erase(node); }
  /// Whether a PDO parameter of the node was written since its last boot-up: then its mapping need not be the
  /// one it starts with.
  bool mapping_was_changed(std::uint8_t node) const { return epochs_.is_written(node); }

  /// Guards a node in every step from now on; what is noticed is among the events.
  void guard(std::uint8_t node, canopen::GuardOptions options);
  void stop_guarding();

  /// servoctl as a heartbeat producer (CiA 301, 7.2.8.2.2.2), state operational: one message at once and one
  /// a period, in every step from now on. `node` 1..127 is servoctl's own.
  void produce_heartbeat(std::uint8_t node, Duration period) {
    heartbeat_ = {node, period, TimePoint::min()};
  }
  void stop_heartbeat() { heartbeat_.reset(); }
  /// One message of such a producer, now.
  Result<void> send_heartbeat(std::uint8_t node);
  /// Under which node-ID servoctl produces heartbeats now; empty when it does not.
  std::optional<std::uint8_t> heartbeat_node() const {
    return heartbeat_ ? std::optional(heartbeat_->node) : std::nullopt;
  }

  /// servoctl as SYNC producer: the first one at once, in every step from now on.
  void produce_sync(const canopen::SyncProducer::Options& options) {
    sync_ = SyncProduction{options, canopen::SyncProducer(options, now())};
  }
  void stop_sync() { sync_.reset(); }
  /// Null where SYNC is not produced.
  const SyncProduction* sync() const { return sync_ ? &*sync_ : nullptr; }

 private:
  friend class CanObjectChannel;
  friend class Hearing;

  /// canopen::NodeWatch in the words of every network.
  class Records final : public NodeRecords {
   public:
    Records(const canopen::NodeWatch& watch, const canopen::NodeGuard& guard)
        : watch_(&watch), guard_(&guard) {}
    std::optional<NodeState> state(std::uint8_t node) const override;
    std::uint32_t boots(std::uint8_t node) const override { return watch_->boots(node); }
    std::uint32_t heartbeats(std::uint8_t node) const override { return watch_->heartbeats(node); }
    const std::deque<canopen::Emergency>& emergencies(std::uint8_t node) const override {
      return watch_->emergencies(node);
    }
    std::uint32_t alarms(std::uint8_t node) const override { return watch_->alarms(node); }

   private:
    const canopen::NodeWatch* watch_;
    const canopen::NodeGuard* guard_;
  };
  struct Heartbeat {
    std::uint8_t node;
    Duration period;
    TimePoint next;
  };

  /// Sends the heartbeat when it is due; the answer is when the next one is.
  Result<TimePoint> send_heartbeat();
  /// The same for SYNC.
  Result<TimePoint> send_sync();
  void hear(const can::Frame& frame);
  /// Once for each node.
  void tell_habit(std::uint8_t node, canopen::SdoHabit habit);
  Result<void> on_report(can::ControllerReport report);
  /// To the channel of the node that the frame belongs to by the pre-defined connection set: answers, what
  /// other masters ask, boot-up.
  void dispatch(const can::Frame& frame);

  std::unique_ptr<can::Bus> bus_;
  std::string url_;
  canopen::NodeWatch watch_;
  canopen::NodeGuard guard_;
  Records records_{watch_, guard_};
  canopen::DuplicateWatch duplicates_;
  canopen::NodeEpochs epochs_;
  std::optional<Heartbeat> heartbeat_;
  std::optional<SyncProduction> sync_;
  can::WireErrors wire_errors_;
  TimePoint wire_error_at_ = TimePoint::min();  ///< When the last one came.
  std::vector<can::ControllerReport> reports_;
  std::set<std::pair<std::uint8_t, canopen::SdoHabit>> told_habits_;
  std::vector<Message> habit_notices_;
  std::optional<can::ControllerReport> last_report_;
  std::map<std::uint8_t, KnownPdos> pdos_;
  std::optional<canopen::LssAddress> lss_selection_;
  std::vector<const OnFrame*> listeners_;
  std::array<CanObjectChannel*, 128> channels_{};  ///< The first of each node.
  std::array<OpenRequests, 128> open_requests_;    ///< As the last channel of each node left them.
  std::deque<NodeEvent> events_;
  std::optional<can::Frame> frame_;
  /// Asking the clock costs a system call on some machines.
  TimePoint stepped_at_{};
  std::set<std::uint8_t> powered_by_pdo_;
};

}  // namespace servoctl::session
