#pragma once

#include <cstdint>
#include <optional>

#include "base/time.hpp"

namespace servoctl::sim {

/// The states of an EtherCAT slave, as the low bits of 0120h and 0130h say them.
enum class EscState : std::uint8_t { init = 1, pre_op = 2, boot = 3, safe_op = 4, op = 8 };

/// AL status codes (0134h; ETG.1000.6, table 11), those that a simulated slave gives.
namespace al_code {
inline constexpr std::uint16_t kNone = 0x0000;
inline constexpr std::uint16_t kInvalidChange = 0x0011;
inline constexpr std::uint16_t kUnknownState = 0x0012;
inline constexpr std::uint16_t kNoBoot = 0x0013;
inline constexpr std::uint16_t kMailbox = 0x0016;
inline constexpr std::uint16_t kSyncManager = 0x0017;
inline constexpr std::uint16_t kWatchdog = 0x001B;
inline constexpr std::uint16_t kOutputs = 0x001D;
inline constexpr std::uint16_t kInputs = 0x001E;
inline constexpr std::uint16_t kInputMapping = 0x0024;
inline constexpr std::uint16_t kOutputMapping = 0x0025;
inline constexpr std::uint16_t kNoFreeRun = 0x0027;
inline constexpr std::uint16_t kNoSync = 0x002D;
inline constexpr std::uint16_t kSyncSettings = 0x0030;
}  // namespace al_code

/// What the state machine asks of the slave, and tells it.
class EscApplication {
 public:
  EscApplication() = default;
  EscApplication(const EscApplication&) = delete;
  EscApplication& operator=(const EscApplication&) = delete;
  virtual ~EscApplication() = default;

  /// Whether the mailboxes are set up as the slave has them, and the process data as its mapping says: 0, or
  /// the AL status code.
  virtual std::uint16_t check_mailboxes() const = 0;
  virtual std::uint16_t check_process_data() = 0;
  /// Whether it can be synchronised as it is set up: 0, or the AL status code.
  virtual std::uint16_t check_synchronisation() const = 0;
  virtual bool outputs_arrive() const = 0;  ///< Outputs have come, and their watchdog has not ended.
  virtual void on_state(EscState from, EscState to) = 0;
};

/// The state machine of an EtherCAT slave (ETG.1000.6, clause 6.4.1; ETG.1020). Reads no clock.
class EscStates {
 public:
  /// From the request of OP to the last moment at which outputs may come for the first time.
  static constexpr Duration kOutputsPatience = std::chrono::milliseconds(200);

  explicit EscStates(EscApplication& application) : application_(&application) {}

  /// Power comes: INIT, and nothing is told.
  void reset();
  /// The master has written 0120h.
  void on_control(std::uint16_t control, TimePoint now);
  /// Outputs have come for the first time, or time goes on.
  void on_time(TimePoint now);
  TimePoint deadline() const { return op_until_; }
  /// The master has switched a sync manager on or off: what the state needs may be gone.
  void on_settings_changed();
  /// The slave leaves its state by itself; does nothing where it is in this or a lower one.
  void fall_to(EscState state, std::uint16_t code);

  EscState state() const { return state_; }
  std::uint16_t code() const { return code_; }
  std::uint16_t status() const;  ///< As 0130h.

 private:
  std::uint16_t refusal(unsigned wanted) const;
  std::uint16_t missing_for(EscState state);
  void request(EscState wanted, TimePoint now);
  void enter(EscState state);
  void refuse(std::uint16_t code);

  EscApplication* application_;
  EscState state_ = EscState::init;
  bool error_ = false;
  std::uint16_t code_ = 0;
  TimePoint op_until_ = kNever;  ///< OP was asked for, and waits for outputs.
};

}  // namespace servoctl::sim
