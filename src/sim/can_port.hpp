#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "canopen/error_control.hpp"
#include "canopen/nmt.hpp"
#include "canopen/sdo_server.hpp"
#include "sim/answer_way.hpp"
#include "sim/device.hpp"
#include "sim/drive_model.hpp"
#include "sim/emergency_producer.hpp"
#include "sim/heartbeat_consumer.hpp"
#include "sim/lss_slave.hpp"
#include "sim/pdo_engine.hpp"

namespace servoctl::sim {

/// What makes a drive a CANopen node: SDO server, PDOs, NMT slave, boot-up, heartbeat, node guarding, the
/// heartbeats it watches, emergencies under the COB-ID of 1014h.
///
/// An NMT reset of the node restarts the drive (DriveModel::reset_node).
class CanPort final : public Device, private DrivePort {
 public:
  /// `model` outlives the port and has no other.
  explicit CanPort(DriveModel& model);

  void on_frame(const can::Frame& frame, TimePoint now) override;
  void on_time(TimePoint now) override;
  std::optional<can::Frame> take_frame() override;
  TimePoint deadline() const override;

  /// Sends what the drive sends unasked; is done with every frame and in on_time() as well.
  void collect_emergencies(TimePoint now);
  WireFaults& faults() { return faults_; }
  void fall_silent_at(TimePoint time) { planned_silence_ = time; }
  canopen::NmtState nmt_state() const { return nmt_; }
  /// From now on it answers LSS; without that a drive that has no node-ID is mute.
  void enable_lss() { lss_.emplace(*model_); }

 private:
  std::uint32_t check_write(ObjectAddress object, ByteSpan data) const override;
  void on_written(ObjectAddress object) override;

  void boot(TimePoint now);
  bool is_unconfigured() const { return model_->node() == canopen::kUnconfigured; }
  void on_lss(const can::Frame& frame, TimePoint now);
  void on_nmt(canopen::NmtCommand command, TimePoint now);
  void set_nmt(canopen::NmtState state, TimePoint now);
  void on_error_control(const can::Frame& frame, TimePoint now);
  void collect_answers(TimePoint now);
  void collect_pdos(TimePoint now);
  void set_up_error_control(TimePoint now);
  void set_up_consumers();
  void on_life_lost(TimePoint now);
  void on_master_lost(TimePoint now);
  void enter_error_state(TimePoint now);
  void queue(const Emergency& emergency);
  void send_emergencies(TimePoint now);
  Duration emergency_inhibit() const;
  const ObjectValues& values() const { return model_->values(); }
  const drive::Rules& rules() const { return model_->profile().rules; }

  DriveModel* model_;
  canopen::SdoServer server_;
  PdoEngine pdos_;
  canopen::ErrorControlSlave error_control_;
  HeartbeatConsumer consumer_;
  std::optional<LssSlave> lss_;
  canopen::NmtState nmt_ = canopen::NmtState::initialising;
  TimePoint boot_at_ = TimePoint::min();  ///< When the boot-up message is due; kNever once it is sent.
  enum class Boot : std::uint8_t { power_on, reset_node, reset_communication };
  Boot boots_ = Boot::power_on;  ///< Why the next boot-up comes.
  EmergencyProducer emergencies_;
  std::deque<can::Frame> tx_;
  AnswerWay answers_;
  WireFaults faults_;
  TimePoint planned_silence_ = kNever;
};

}  // namespace servoctl::sim
