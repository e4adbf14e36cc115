#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ethercat/coe_info.hpp"
#include "od/eds.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// An entry as the drive describes it; empty when it can neither be read nor written, as places that nothing
/// stands at. A type CiA 301 does not know is taken by its bits, which its note says.
std::optional<od::Entry> online_entry(const ethercat::CoeEntry& described);

/// The dictionary of a drive as it describes it itself, and the identity it has.
struct OnlineDictionary {
  od::EdsFile sheet;
  std::vector<Message>
      left_out;  ///< Objects and entries that it lists and does not describe, each with the reason.
};

/// Asks a drive on EtherCAT for all its objects (SDO information, ETG.1000.6, 5.6.3): two questions for an
/// object of one value, one more for each further entry. Errc::usage on a network without that, or the errors
/// of the list, with what to use instead; what cannot be described after that is left out.
Result<OnlineDictionary> read_online_dictionary(Session& session, std::uint8_t node);

}  // namespace servoctl::session
