#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/time.hpp"
#include "sim/drive_model.hpp"
#include "sim/esc_coe.hpp"
#include "sim/esc_controller.hpp"
#include "sim/esc_faults.hpp"
#include "sim/esc_lies.hpp"
#include "sim/esc_mailbox.hpp"
#include "sim/esc_process_data.hpp"
#include "sim/esc_sii_image.hpp"
#include "sim/esc_states.hpp"

namespace servoctl::sim {

/// A drive of a family on EtherCAT: a drive model with a slave controller around it, its state machine, its
/// mailbox with CoE, and its process data. Frames pass through it; it has no power before power_on().
/// Performs no I/O and reads no clock.
///
/// What the standard leaves to a drive is answered like this: outputs are taken over after the frame that
/// brought them, inputs are those of the moment a frame comes; the outputs that lie there when OP begins are
/// taken over at once, whatever they are; a drive that has power when OP ends takes it as the loss of its
/// master.
class EscSlave final : private DrivePort, private EscApplication {
 public:
  struct Options {
    EscCoe::Options coe;
    SiiFault sii = SiiFault::none;
    std::uint16_t alias = 0;

    /// SDO information and complete access as the family's rules say.
    static Options of(const drive::Profile& profile);
  };

  /// As DriveModel's; `node` is what its objects take for their node-ID. The family has [coe] rules.
  EscSlave(const drive::Profile& profile, std::uint8_t node, Memory& memory, std::string key,
           Options options);
  EscSlave(const drive::Profile& profile, std::uint8_t node, Memory& memory, std::string key)
      : EscSlave(profile, node, memory, std::move(key), Options::of(profile)) {}

  /// Its power comes, or comes back: INIT, station address 0, and the model as after power-on.
  void power_on(TimePoint now);
  /// A frame passes, and is changed in place. False: it goes no further.
  bool on_frame(std::span<std::uint8_t> frame, TimePoint now);
  void on_time(TimePoint now);
  TimePoint deadline() const;

  DriveModel& model() { return model_; }
  const DriveModel& model() const { return model_; }
  EscFaults& faults() { return faults_; }
  /// How it will lie once its drive was enabled.
  void plan_lies(EscLies lies) { lies_ = std::move(lies); }
  /// It leaves its state at this time; only once.
  void plan_fall(PlannedFall fall) { fall_ = fall; }
  EscState state() const { return states_.state(); }
  std::uint16_t al_code() const { return states_.code(); }
  /// For the wire, and for tests that look past it.
  EscRegisters& registers() { return controller_.registers(); }
  const EscRegisters& registers() const { return controller_.registers(); }

 private:
  struct Request {
    std::uint16_t control = 0;
    TimePoint due;
  };

  std::uint32_t check_write(ObjectAddress object, ByteSpan data) const override;
  void on_written(ObjectAddress) override {}
  std::uint32_t check_assignment(ObjectAddress object, ByteSpan data) const;

  std::uint16_t check_mailboxes() const override;
  std::uint16_t check_process_data() override;
  std::uint16_t check_synchronisation() const override;
  bool outputs_arrive() const override;
  void on_state(EscState from, EscState to) override;

  bool lies_free(unsigned number) const;
  void work(TimePoint now);
  void lie(TimePoint now);
  void begin_to_lie();
  void end_lies();
  void show_state();
  void apply_outputs();
  void sample_inputs(TimePoint now);
  void leave_op(bool by_watchdog);
  std::uint16_t lost_code() const;

  DriveModel model_;
  EscController controller_;
  EscFaults faults_;
  EscProcessData process_data_;
  EscCoe coe_;
  EscMailbox mailbox_;
  EscStates states_;
  std::uint16_t assign_outputs_ = 0;  ///< 1C12h and 1C13h, where the family has them.
  std::uint16_t assign_inputs_ = 0;
  bool applies_ = false;       ///< A write comes with the process data.
  bool outputs_seen_ = false;  ///< Since SAFE-OP began, or the watchdog ended.
  bool master_lost_ = false;   ///< The watchdog ends OP.
  std::optional<TimePoint> sampled_at_;
  std::optional<Request> request_;
  PlannedFall fall_;
  EscLies lies_;
  std::optional<EscFaults> honest_;      ///< Its faults before it began to lie.
  std::optional<TimePoint> enabled_at_;  ///< When its drive was enabled for the first time.
};

}  // namespace servoctl::sim
