#pragma once

#include <array>
#include <deque>
#include <set>
#include <string>
#include <unordered_map>

#include "canopen/emergency.hpp"
#include "canopen/error_control.hpp"
#include "canopen/nmt.hpp"
#include "canopen/sdo_server.hpp"
#include "drive/profile.hpp"
#include "sim/axis.hpp"
#include "sim/device.hpp"
#include "sim/emergency_producer.hpp"
#include "sim/error_log.hpp"
#include "sim/heartbeat_consumer.hpp"
#include "sim/memory.hpp"
#include "sim/object_values.hpp"
#include "sim/pdo_engine.hpp"
#include "sim/power_stage.hpp"

namespace servoctl::sim {

/// Ways in which a simulated drive misbehaves; all off at first.
struct Misbehaviour {
  bool silent = false;                           ///< Says nothing and hears nothing: the cable is out.
  std::uint32_t drop_answers = 0;                ///< So many SDO answers are lost on the way.
  std::uint32_t duplicate_answers = 0;           ///< So many SDO answers arrive twice.
  Duration answer_delay{};                       ///< Every SDO answer comes this late.
  std::set<std::uint16_t> missing;               ///< Objects that its EDS tells of and it does not have.
  std::set<std::uint16_t> unreadable;            ///< Objects whose reads it refuses.
  std::set<std::uint16_t> feigned;               ///< Objects whose writes it acknowledges and does not do.
  std::set<std::uint16_t> refused;               ///< Objects whose writes it refuses.
  bool ignores_disable = false;                  ///< Takes 00h, 02h and 07h, and stays energised.
  bool stays_switched_on = false;                ///< Takes 00h, and goes no lower than "switched on".
  std::optional<std::uint16_t> statusword = {};  ///< What it says, whatever state it is in.
};

/// A drive of a family, made from its profile: object dictionary behind an SDO server, NMT slave, boot-up,
/// heartbeat, emergencies, CiA 402 states, panel parameters with non-volatile memory.
///
/// What the manual leaves open is answered like this: a panel parameter is kept at once when it is written,
/// an object of the communication or device profile only by 1010h; an NMT reset of the node restarts the
/// drive as a power cycle does, one of the communication gives 1000h to 1FFFh what they have after that (CiA
/// 301, 7.3.2.2.1).
class SimDrive final : public Device, private canopen::ObjectStore {
 public:
  /// `profile` and `memory` outlive the drive. `key` names its cells in the memory; `node` is the node-ID it
  /// is set to.
  SimDrive(const drive::Profile& profile, std::uint8_t node, Memory& memory, std::string key);

  void on_frame(const can::Frame& frame, TimePoint now) override;
  void on_time(TimePoint now) override;
  std::optional<can::Frame> take_frame() override;
  TimePoint deadline() const override;

  /// The drive detects an error: emergency, history, fault reaction.
  void raise_fault(std::uint16_t code, std::array<std::uint8_t, 5> vendor, TimePoint now);
  /// Misbehaves or raises a fault later on.
  struct Alarm {
    std::uint16_t code = 0;
    std::array<std::uint8_t, 5> vendor{};
  };
  void raise_fault_at(Alarm alarm, TimePoint time) { planned_fault_ = {alarm, time}; }
  void fall_silent_at(TimePoint time) { planned_silence_ = time; }
  Misbehaviour& misbehaviour() { return misbehaviour_; }
  /// The enable input, or STO: no power while it is off.
  void set_torque_off(bool off) { power_.set_torque_off(off); }
  AxisFaults& axis_faults() { return axis_.faults(); }
  Track& track() { return axis_.track(); }
  /// As Axis::own_counts().
  double& own_counts() { return axis_.own_counts(); }

  const drive::Profile& profile() const { return *profile_; }
  std::uint8_t node() const { return node_; }
  canopen::NmtState nmt_state() const { return nmt_; }
  drive::DriveState power_state() const { return power_.state(); }
  bool is_moving() const { return axis_.is_moving(); }
  /// What an object holds, as its bytes; for tests that look past the bus.
  const Bytes& value(ObjectAddress object) const { return values_.get(object); }
  /// Writes that went to the memory that outlives power-off since the drive was made.
  std::uint64_t flash_writes() const { return flash_writes_; }

 private:
  struct Planned {
    Alarm alarm;
    TimePoint time;
  };
  struct Delayed {
    can::Frame frame;
    TimePoint time;
  };

  std::uint32_t read(ObjectAddress object, Bytes& out) override;
  std::uint32_t check_writable(ObjectAddress object) override;
  std::uint32_t write(ObjectAddress object, ByteSpan data) override;
  std::uint32_t check_state(ObjectAddress object, ByteSpan data) const;
  void after_write(ObjectAddress object, ByteSpan data);
  bool feigns(std::uint16_t controlword);
  std::uint32_t write_command(ObjectAddress object, ByteSpan data, bool& handled);
  std::uint32_t save_objects(std::uint8_t group);
  std::uint32_t restore_objects(std::uint8_t group);

  void power_on(TimePoint now);
  void load_values(TimePoint now);
  void load_communication_area();
  void load_mirrors();
  void restore_if_asked();
  void on_nmt(canopen::NmtCommand command, TimePoint now);
  void set_nmt(canopen::NmtState state);
  bool is_enabled() const { return power_.state() == drive::DriveState::operation_enabled; }
  bool is_locked(ObjectAddress object) const;
  bool is_kept(ObjectAddress object) const;
  bool may_reset() const;
  void clear_fault();
  void begin_error(ErrorLog::Source source, std::uint16_t code, std::array<std::uint8_t, 5> vendor);
  void end_error(ErrorLog::Source source);
  bool raise_alarm(std::string_view panel);
  void raise_access_alarm(ObjectAddress object, std::uint32_t code);
  void collect_answers(TimePoint now);
  void collect_pdos();
  void set_up_error_control(TimePoint now);
  void on_life_lost(TimePoint now);
  void set_up_consumers();
  void on_master_lost(TimePoint now);
  void react_to_lost_master(TimePoint now);
  void enter_error_state();
  void move_axis();
  void send_emergency(std::uint16_t code, std::array<std::uint8_t, 5> vendor);
  void collect_emergencies();
  Duration emergency_inhibit() const;
  std::uint64_t effective(ObjectAddress object) const;
  const od::Parameter* parameter(const std::string& id) const {
    return id.empty() ? nullptr : profile_->parameter(id);
  }

  const drive::Profile* profile_;
  Memory* memory_;
  std::string key_;
  std::uint8_t node_;
  ObjectValues values_;
  std::unordered_map<ObjectAddress, std::uint64_t> at_start_;  ///< Parameters that take effect by a restart.
  PowerStage power_;
  Axis axis_;
  canopen::SdoServer server_;
  PdoEngine pdos_;
  canopen::ErrorControlSlave error_control_;
  HeartbeatConsumer consumer_;
  canopen::NmtState nmt_ = canopen::NmtState::initialising;
  TimePoint now_{};
  TimePoint boot_at_ = TimePoint::min();  ///< When the boot-up message is due; kNever once it is sent.
  bool full_restart_ = true;
  ErrorLog errors_;
  EmergencyProducer emergencies_;
  const drive::Fault* fault_ = nullptr;  ///< The present one, when its code tells which it is.
  std::uint64_t flash_writes_ = 0;
  std::deque<can::Frame> tx_;
  std::deque<Delayed> late_;
  Misbehaviour misbehaviour_;
  std::optional<Planned> planned_fault_;
  TimePoint planned_silence_ = kNever;
};

}  // namespace servoctl::sim
