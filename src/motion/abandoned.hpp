#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "show/desk.hpp"

namespace servoctl::motion {

/// Looks at drives that somebody else energised through this session, and who is gone now: those that have
/// power, or do not tell, are stopped and disabled, all at the same time. What was done is told at once, what
/// did not succeed is in `desk.errors`. Does not hear Ctrl-C.
void stop_abandoned(show::Desk& desk, const std::set<std::uint8_t>& nodes);

/// The parameters that somebody else wrote through this session to energise motors without the controlword,
/// which stop_abandoned() does not end.
class PowerWrites {
 public:
  /// Notes a write before it is sent, if it is such a one; whether it is.
  bool note(const drive::Profile* profile, std::uint8_t node, ObjectAddress object, ByteSpan data);
  /// Writes to these drives what ends it. Told as stop_abandoned() tells it; does not hear Ctrl-C.
  void end(show::Desk& desk, const std::set<std::uint8_t>& nodes);

 private:
  std::map<std::uint8_t, std::set<std::string>> names_;
};

}  // namespace servoctl::motion
