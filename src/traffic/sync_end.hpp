#pragma once

#include <string>
#include <vector>

#include "report/value.hpp"
#include "session/session.hpp"

namespace servoctl::traffic {

/// What became of a SYNC that was produced.
struct SyncEnd {
  report::Table table;                ///< Periods as they were measured, and how many were missed.
  std::vector<std::string> warnings;  ///< Drives left energised that may follow SYNC.
};

/// Ends the SYNC that the session produces; there has to be one.
SyncEnd end_sync(session::Session& session);

}  // namespace servoctl::traffic
