#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "motion/motion_units.hpp"
#include "motion/power.hpp"
#include "motion/watchdog.hpp"
#include "session/foreign_writes.hpp"
#include "session/rehearsal.hpp"

namespace servoctl::motion {

/// In which state a motion left the drive.
struct MotionEnd {
  bool verified = false;  ///< The statusword was read afterwards and shows a state without power.
  drive::DriveState state = drive::DriveState::unknown;
  std::uint16_t statusword = 0;
  bool stopped = false;            ///< It stood still before its power was taken away.
  bool quick_stop = false;         ///< It needed a quick stop for that.
  bool watched = false;            ///< The watchdog was set for the motion and left so.
  std::vector<std::string> left;   ///< What could not be put back, and why.
  std::vector<std::string> notes;  ///< What was left otherwise than before for a reason.
};

/// Holds a drive while it is energised: whatever way the owner is left by, the drive is stopped, its power is
/// taken away, what was changed is put back, and the end state is verified. While that goes on, nothing is
/// interrupted.
class MotionGuard {
 public:
  static constexpr std::string_view kTwoMasters = "two masters command the drive: stop the other one";

  MotionGuard(session::Session& session, const MotionUnits& units, std::uint8_t node);
  MotionGuard(const MotionGuard&) = delete;
  MotionGuard& operator=(const MotionGuard&) = delete;
  ~MotionGuard();

  /// Reads by which PDOs another master could write what decides about the motion: foreign_command() knows
  /// them then, as it knows SDOs.
  Result<void> learn_rpdos() {
    return rehearsal_ != nullptr ? Result<void>() : foreign_writes_.learn_rpdos(units_->profile());
  }
  /// From now on nothing is sent: what would be goes there, which outlives this. To be called first.
  void rehearse(session::Rehearsal& rehearsal) { rehearsal_ = &rehearsal; }
  /// As Power::set_other_source().
  void set_other_source(std::optional<OtherSource> source) { power_.set_other_source(std::move(source)); }

  /// Writes an object, after its value was kept; end() puts it back. The first time one that holds the bytes
  /// already is not written. One that was written before is written again without a look: a motor that is to
  /// be stopped does not wait for an answer.
  Result<void> change(ObjectAddress object, const Bytes& data);
  /// The same for the mode of operation; waits until the drive is in it.
  Result<void> change_mode(std::int8_t mode);
  /// Sets the targets so that enabling does not move the motor: 60FFh and 6071h to 0, 607Ah to where it
  /// stands. Objects in `except` are left alone.
  Result<void> neutral_targets(std::optional<ObjectAddress> except = {});
  /// Makes the drive watch servoctl until end().
  Result<void> arm(const WatchdogPlan& plan);
  /// Where the family chooses by a switch whether writes go to its flash: to the RAM, until end().
  Result<void> spare_flash();
  /// A drive of this network obeys process data only: its node is started before anything is set for a
  /// motion, because it may not follow before.
  bool needs_process_data() const;
  /// Starts the node where the family, or the network, has its drives energised in Operational only.
  Result<void> start_node();
  /// "Operation enabled", by the shortest legal way. Errc::refused when somebody else has enabled it,
  /// Errc::negative when foreign_command() knows of one: two masters would command it.
  Result<void> enable();

  /// Of what decides about the motion (6040h, 6060h, the targets, and the RPDOs by which they may come), what
  /// another master has written since.
  struct ForeignCommand {
    ObjectAddress object;
    session::ForeignWrites::Way way;
    bool by_pdo() const { return way == session::ForeignWrites::Way::rpdo; }
  };
  std::optional<ForeignCommand> foreign_command() const;

  /// The speed below which the motor counts as standing still, in the unit of 606Ch.
  void set_standstill(double speed) { standstill_ = speed; }

  /// Ends the motion; the first call does it, further ones tell the same.
  MotionEnd end();
  /// Leaves the drive energised and its objects as they are, because that was asked for. Takes the watchdog
  /// back.
  Result<void> release();

 private:
  struct Changed {
    ObjectAddress object;
    Bytes before;
  };

  Result<void> write(ObjectAddress object, const Bytes& data);
  Result<void> wait_until_awake();
  void rehearse_up(const std::vector<drive::PowerStep>& path);
  void rehearse_end();
  bool stays_new(const Changed& changed) const;
  std::optional<session::SdoRequest> zero_target() const;
  PowerDownPlan way_down();
  void bring_down();
  void put_back();
  void put_back(const Changed& changed);
  void keep_mode();
  void hear_write(ObjectAddress object, session::ForeignWrites::Way way);
  Result<void> send_life_sign(const session::LifeSign& sign);
  /// Sends a controlword without waiting for anything and without memory.
  void say(std::uint8_t controlword) noexcept;
  void tell_foreign_writes();
  void disarm();
  void put_node_back();
  void return_to_op();
  void tell_other_axes();
  void verify();
  void note(const std::string& what, const Error& error);

  session::Session* session_;
  const MotionUnits* units_;
  std::uint8_t node_;
  Power power_;
  session::Protection::Hold hold_;
  std::vector<Changed> changed_;
  std::optional<std::int8_t> mode_;  ///< That was chosen for the motion.
  std::optional<WatchdogPlan> watchdog_;
  bool started_ = false;      ///< It was told to become operational.
  bool held_before_ = false;  ///< Process data were exchanged with it in OP already.
  std::optional<session::NodeState> state_before_;
  bool energised_ = false;  ///< It was commanded up, so it may be.
  bool armed_ = false;      ///< The watchdog was set.
  bool lost_ = false;       ///< The drive or the bus does not answer any more.
  bool powered_ = false;    ///< Its power could not be taken away.
  std::optional<double> standstill_;
  std::optional<MotionEnd> end_;
  MotionEnd result_;
  std::set<ObjectAddress> own_;  ///< What it has set, or found as it was to be set.
  /// Of those, what another master wrote since, and how.
  std::map<ObjectAddress, session::ForeignWrites::Way> foreign_;
  session::ForeignWrites foreign_writes_;
  session::Rehearsal* rehearsal_ = nullptr;
};

}  // namespace servoctl::motion
