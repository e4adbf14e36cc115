#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "canopen/emergency.hpp"
#include "drive/rules.hpp"
#include "ethercat/al_status.hpp"
#include "ethercat/coe_slave.hpp"
#include "ethercat/process_image.hpp"
#include "ethercat/sync_clock.hpp"
#include "session/node_state.hpp"

namespace servoctl::session {

class EtherCatObjectChannel;
class EtherCatValues;

/// Station addresses that servoctl gives: 1001h to the first slave.
constexpr std::uint16_t station_of(std::uint8_t node) { return static_cast<std::uint16_t>(0x1000U + node); }

/// `INIT` and so on in the words of every network.
NodeState node_state(ethercat::AlState state);

/// A slave in SAFE-OP or OP that servoctl has not brought there: somebody exchanges process data with it. One
/// that fell out of OP is nobody's.
constexpr bool is_driven(const ethercat::AlStatus& al) {
  return al.state == ethercat::AlState::op || (al.state == ethercat::AlState::safeop && !al.error);
}

/// What a network keeps of one slave, from the first time it is asked for something.
struct EtherCatNode {
  /// What the drive had in its assignment objects before servoctl chose PDOs for an exchange.
  struct Assignment {
    std::uint16_t index = 0;
    std::uint8_t count = 0;           ///< Of those below that hold; the rest lies behind them.
    std::vector<std::uint16_t> pdos;  ///< One at least.

    std::vector<std::uint16_t> in_use() const { return {pdos.begin(), pdos.begin() + count}; }
  };

  explicit EtherCatNode(std::uint8_t node) : number(node) {}

  ethercat::SlaveAddress address() const { return ethercat::SlaveAddress::station(station_of(number)); }
  bool exchanges() const { return image != nullptr && image->running(); }

  std::uint8_t number;
  drive::CoeRules rules;                    ///< Of its family, as far as somebody knows it.
  std::unique_ptr<ethercat::CoeSlave> coe;  ///< Set when objects can be read.
  EtherCatObjectChannel* owner = nullptr;   ///< Whose transfer its client carries.
  std::unique_ptr<ethercat::ProcessImage> image;
  std::optional<ethercat::SyncClock> clock;  ///< Where the drive demands SYNC0.
  bool raised = false;                       ///< servoctl has taken it above PRE-OP.
  bool kept = false;                         ///< The user wants it in OP.
  std::vector<Assignment> assigned;
  Duration watchdog = std::chrono::milliseconds(100);
  TimePoint output_at{};                   ///< When it took an output last that was set by object.
  std::vector<EtherCatValues*> listeners;  ///< Told whenever its image was served.

  // What was heard of it.
  std::optional<ethercat::AlStatus> al;
  TimePoint heard_at{};
  std::uint32_t boots = 0;
  std::uint32_t reports = 0;
  unsigned missed = 0;  ///< Looks in succession that it did not answer.
  bool gone = false;
  std::deque<canopen::Emergency> emergencies;
  std::uint32_t alarms = 0;
};

}  // namespace servoctl::session
