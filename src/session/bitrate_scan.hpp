#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "can/link_change.hpp"
#include "session/bitrate_search.hpp"
#include "session/identity.hpp"
#include "session/scan.hpp"
#include "session/session.hpp"

/// Drives found by asking at each bitrate in turn, on a bus on which nobody talks.
namespace servoctl::session {

/// What came of one bitrate.
struct Asked {
  std::uint32_t bitrate = 0;
  std::size_t nodes = 0;  ///< That answered.
  std::string why = {};   ///< Nobody did because: `not possible`, or what became of the bus; empty: silence.
};

struct BitrateScan {
  std::vector<Asked> asked;  ///< In the order in which they were tried; ends with one that answers.
  std::optional<std::uint32_t> bitrate;  ///< Where nodes answered: the interface is left there.
  std::vector<Identity> found;           ///< As scan().
};

/// Listens at the present bitrate: Errc::refused when anything is heard, frames or errors.
Result<void> hold_silence(can::LinkControl& link, Duration time, const std::function<bool()>& cancelled,
                          const Listening& listening = {});

/// Asks at each bitrate by scan(), until nodes answer. The interface stays at the bitrate where they do;
/// where none does, or on any other way out, it is put back to what it was, and the session with it.
/// Errc::interrupted when cancelled; Errc::usage where the interface has no bitrate to set; Errc::bus when it
/// is lost.
Result<BitrateScan> scan_bitrates(Session& session, can::LinkControl& link,
                                  std::span<const std::uint8_t> nodes,
                                  std::span<const std::uint32_t> bitrates,
                                  const std::function<void(const Asked&)>& told,
                                  const BeforeDetails& before_details = {});

}  // namespace servoctl::session
