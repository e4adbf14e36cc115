#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/time.hpp"
#include "canopen/object_store.hpp"
#include "drive/profile.hpp"
#include "sim/axis.hpp"
#include "sim/drive_port.hpp"
#include "sim/error_log.hpp"
#include "sim/memory.hpp"
#include "sim/object_values.hpp"
#include "sim/power_stage.hpp"

namespace servoctl::sim {

/// Ways in which a drive misbehaves, whatever wire it hangs on; all off at first.
struct Misbehaviour {
  std::set<std::uint16_t> missing;               ///< Objects that its EDS tells of and it does not have.
  std::set<std::uint16_t> unreadable;            ///< Objects whose reads it refuses.
  std::set<std::uint16_t> feigned;               ///< Objects whose writes it acknowledges and does not do.
  std::set<std::uint16_t> refused;               ///< Objects whose writes it refuses.
  bool ignores_disable = false;                  ///< Takes 00h, 02h and 07h, and stays energised.
  bool stays_switched_on = false;                ///< Takes 00h, and goes no lower than "switched on".
  std::optional<std::uint16_t> statusword = {};  ///< What it says, whatever state it is in.
  std::optional<std::int8_t> mode = {};          ///< What 6061h says, whatever mode it is in.
};

/// An error by its code (603Fh) and the bytes that its maker adds.
struct Alarm {
  std::uint16_t code = 0;
  std::array<std::uint8_t, 5> vendor{};
};

/// What a drive sends once when an error occurs, or with code 0000h when it is over (CiA 301, 7.2.7.1).
struct Emergency {
  std::uint16_t code = 0;
  std::uint8_t error_register = 0;  ///< 1001h when it happened.
  std::array<std::uint8_t, 5> vendor{};

  bool operator==(const Emergency&) const = default;
};

/// A drive of a family, made from its profile: objects, panel parameters with non-volatile memory, CiA 402
/// states, an axis, faults. It knows no wire: a port (DrivePort) brings it reads and writes and tells it what
/// becomes of the communication; without one it does what its objects say. Performs no I/O and reads no
/// clock. It has no power before power_on().
///
/// What the manual leaves open is answered like this: a panel parameter is kept at once when it is written,
/// an object of the communication or device profile only by 1010h; a reset of the communication gives 1000h
/// to 1FFFh what they have after power-on (CiA 301, 7.3.2.2.1).
class DriveModel final : public canopen::ObjectStore {
 public:
  /// `profile` and `memory` outlive the drive. `key` names its cells in the memory; `node` is the node-ID it
  /// is set to.
  DriveModel(const drive::Profile& profile, std::uint8_t node, Memory& memory, std::string key);
  /// The port outlives the drive.
  void attach(DrivePort& port) { port_ = &port; }

  /// Its power comes, or comes back: what is not in its memory is lost.
  void power_on(TimePoint now);
  /// NMT reset node: as power_on(), but where the family's parameters need a power cycle to take effect, they
  /// keep what they are.
  void reset_node(TimePoint now);
  /// Only 1000h to 1FFFh begin anew; state, motion and faults go on.
  void reset_communication(TimePoint now);
  /// Whether process data are exchanged. Some families take away the power when that ends.
  void set_operational(bool operational);
  /// A synchronous RPDO has brought 60C1h:01, and its SYNC has come.
  void take_interpolation_point();
  /// The master that is watched has fallen silent: what 6007h says, a fault where there is none; the
  /// emergency has this code.
  void on_master_lost(std::uint16_t code, TimePoint now);

  /// What comes next comes at this time; nothing happens by itself before on_time().
  void set_time(TimePoint now) { now_ = now; }
  void on_time(TimePoint now);
  TimePoint deadline() const;
  TimePoint now() const { return now_; }

  std::uint32_t read(ObjectAddress object, Bytes& out) override;
  std::uint32_t check_writable(ObjectAddress object) override;
  std::size_t expedited_size(ObjectAddress object, std::size_t announced) override;
  std::uint32_t write(ObjectAddress object, ByteSpan data) override;

  /// The drive detects an error: emergency, history, fault reaction.
  void raise_fault(std::uint16_t code, std::array<std::uint8_t, 5> vendor, TimePoint now);
  void raise_fault_at(Alarm alarm, TimePoint time) { planned_fault_ = {alarm, time}; }
  /// An error that is no fault of the drive, or is one: told once, when it begins.
  void begin_error(ErrorLog::Source source, std::uint16_t code, std::array<std::uint8_t, 5> vendor = {});
  /// It is over: told by code 0000h, with what is still wrong in the register. Does nothing when there is
  /// none.
  void end_error(ErrorLog::Source source);
  bool has_error(ErrorLog::Source source) const { return errors_.is_present(source); }
  /// The next to be told, in their order.
  std::optional<Emergency> take_emergency();
  bool has_emergency() const { return !emergencies_.empty(); }

  Misbehaviour& misbehaviour() { return misbehaviour_; }
  /// The enable input, or STO: no power while it is off.
  void set_torque_off(bool off) { power_.set_torque_off(off); }
  AxisFaults& axis_faults() { return axis_.faults(); }
  Track& track() { return axis_.track(); }
  /// As Axis::panel().
  std::map<std::string, std::int64_t, std::less<>>& panel() { return axis_.panel(); }
  /// As in Axis.
  bool has_own_counts() const { return axis_.has_own_counts(); }
  double& own_counts() { return axis_.own_counts(); }

  const drive::Profile& profile() const { return *profile_; }
  /// 255 when it has none (CiA 305).
  std::uint8_t node() const { return node_; }
  /// The node-ID it is to have from reset_communication() on, 255 for none; power_on() brings back what is
  /// stored.
  void set_node(std::uint8_t node) { node_ = node; }
  /// Keeps a node-ID for the time behind power-off; false when the memory cannot be written.
  bool store_node(std::uint8_t node);
  /// 1018h:04, where it is not its family's; holds from power_on() on.
  void set_serial(std::uint32_t serial) { serial_ = serial; }
  std::optional<std::uint32_t> serial() const { return serial_; }
  drive::DriveState power_state() const { return power_.state(); }
  bool is_moving() const { return axis_.is_moving(); }
  /// What its objects hold, past the checks of read().
  const ObjectValues& values() const { return values_; }
  /// Sets a parameter as on the panel, before the drive starts; false for one that the family does not have,
  /// or that does not take the value.
  bool set_on_panel(const std::string& id, std::int64_t value);
  /// What a panel parameter is set to, as it took effect; empty where the family has none of this name.
  std::optional<std::uint64_t> setting(const std::string& id) const;
  /// Writes that went to the memory that outlives power-off since the drive was made.
  std::uint64_t flash_writes() const { return flash_writes_; }

 private:
  struct Planned {
    Alarm alarm;
    TimePoint time;
  };

  std::uint32_t check_state(ObjectAddress object, ByteSpan data) const;
  void after_write(ObjectAddress object, ByteSpan data);
  void on_controlword(std::uint16_t controlword);
  bool feigns(std::uint16_t controlword);
  Bytes taken_period(ByteSpan data) const;
  std::uint32_t write_command(ObjectAddress object, ByteSpan data, bool& handled);
  std::uint32_t save_objects(std::uint8_t group);
  std::uint32_t restore_objects(std::uint8_t group);

  void load_values(bool restarts, TimePoint now);
  void begin_memory(std::uint8_t node);
  std::optional<std::uint8_t> kept_node() const;
  void load_communication_area();
  void load_mirrors();
  void restore_if_asked();
  void begin_communication();
  bool is_enabled() const { return power_.state() == drive::DriveState::operation_enabled; }
  Axis::Drive motor_drive() const;
  void begin_stop(const std::string& ramp);
  void give_controlword(std::uint16_t controlword);
  bool obeys_bus() const;
  bool is_locked(ObjectAddress object) const;
  bool is_kept(ObjectAddress object) const;
  bool may_reset() const;
  void clear_fault();
  bool raise_alarm(std::string_view panel);
  void raise_access_alarm(ObjectAddress object, std::uint32_t code);
  void tell(std::uint16_t code, std::array<std::uint8_t, 5> vendor);
  void move_axis();
  std::uint64_t effective(ObjectAddress object) const { return load_le(values_.in_force(object)); }
  const od::Parameter* parameter(const std::string& id) const {
    return id.empty() ? nullptr : profile_->parameter(id);
  }

  const drive::Profile* profile_;
  Memory* memory_;
  std::string key_;
  std::uint8_t node_;
  DrivePort* port_ = nullptr;
  ObjectValues values_;
  PowerStage power_;
  Axis axis_;
  bool ramps_down_ = false;  ///< The present quick stop or fault reaction has a ramp.
  bool operational_ = false;
  TimePoint now_{};
  ErrorLog errors_;
  std::deque<Emergency> emergencies_;
  const drive::Fault* fault_ = nullptr;  ///< The present one, when its code tells which it is.
  std::uint64_t flash_writes_ = 0;
  Misbehaviour misbehaviour_;
  std::optional<Planned> planned_fault_;
  std::optional<std::uint32_t> serial_;
};

}  // namespace servoctl::sim
