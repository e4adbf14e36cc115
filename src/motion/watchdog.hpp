#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "drive/standard_objects.hpp"
#include "motion/lost_master.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// What stops the drive when servoctl or the cable dies.
struct WatchdogPlan {
  enum class Kind : std::uint8_t {
    none,       ///< The family has neither: nothing stops the drive.
    heartbeat,  ///< Heartbeat consumer, 1016h; servoctl is the producer.
    guarding,  ///< Life guarding, 100Ch and 100Dh; servoctl asks. Not where the drive itself sends heartbeats
               ///< or masks the alarm of it.
    sync_manager,  ///< Outputs of a process image (ETG.1000.4, 6.3): without them the drive leaves OP.
  };
  Kind kind = Kind::none;
  Duration time{};                      ///< From the last message until the drive reacts.
  std::uint8_t producer = 0;            ///< Node-ID under which servoctl sends heartbeats.
  std::uint8_t entry = 0;               ///< Sub-index of 1016h.
  std::set<std::uint8_t> watched = {};  ///< Node-IDs that the drive watches already.
  std::string reaction = {};            ///< What the drive does then, by 6007h; empty when it does not tell.
  bool reaction_off = false;            ///< 6007h is 0, no action: it has to be set as well.
  std::optional<std::int64_t> option = {};  ///< 6007h as it is in the motion, where the drive has it.
  bool power_off = false;                   ///< LostMaster::power_off
  std::string fault = {};                   ///< lost_master_fault()
  bool assumed = false;  ///< The manual does not say what the motor does when the master is lost.
  std::vector<std::string> alarms = {};  ///< What the manual calls a lost communication; it tells no more.
  std::string remark = {};               ///< Why there is none, or on what it depends; may be empty.

  /// Whether it is known that the motor stops: CiA 301 promises a change of the NMT state alone (1029h).
  Stops stops() const {
    return LostMaster{kind != Kind::none, option, power_off, !fault.empty(), !alarms.empty(), assumed}
        .stops();
  }
};

/// 6007h, and its value for a fault (CiA 402-2, abort connection option code).
inline constexpr std::uint8_t kReactWithFault = 1;

/// Time of the watchdog unless asked otherwise; servoctl sends five messages in it.
inline constexpr Duration kWatchdogTime = std::chrono::milliseconds(500);

/// The same over EtherCAT, where process data are exchanged every 4 ms: what masters use there by default.
inline constexpr Duration kOutputsTime = std::chrono::milliseconds(100);

/// How long the bus is listened to before a node-ID counts as free: masters that only send heartbeats send
/// one at least so often.
inline constexpr Duration kListening = std::chrono::seconds(1);

/// How long others are listened to before one of their node-IDs counts as free: kListening, or no longer than
/// until now, for what is only shown.
enum class Listening : std::uint8_t { full, so_far };

/// Finds out which watchdog the drive has; only reads. `producer`: servoctl's node-ID, where the user names
/// one; else the highest that nobody was heard under since the bus was opened, for which it waits up to
/// kListening. The number is servoctl's own only after claim_producer(). Errc::refused when somebody was
/// heard under the number that the user names.
Result<WatchdogPlan> plan_watchdog(session::Session& session, const drive::Profile& profile,
                                   std::uint8_t node, std::optional<std::uint8_t> producer,
                                   Listening listening = Listening::full);

/// The highest node-ID under which nobody was heard and nobody answers, but for the drive's own and those it
/// watches; empty when there is none.
Result<std::optional<std::uint8_t>> next_producer(session::Session& session, std::uint8_t node,
                                                  const std::set<std::uint8_t>& watched);

/// `heartbeat: the drive stops by itself after 500 ms without servoctl (fault)`.
std::string to_string(const WatchdogPlan& plan);

/// What is to be expected of a motor that can no longer be told to stop: `whether it stops by itself is not
/// known`. `armed`: the watchdog was set, and is set still.
std::string expectation(const WatchdogPlan& plan, bool armed);

}  // namespace servoctl::motion
