#pragma once

#include "base/rhythm.hpp"
#include "canopen/sync.hpp"

namespace servoctl::session {

/// servoctl as SYNC producer, and how evenly it is one.
struct SyncProduction {
  canopen::SyncProducer::Options options;
  canopen::SyncProducer producer;
  Rhythm rhythm = {};
  std::uint64_t foreign = 0;  ///< SYNCs that somebody else sent meanwhile.
};

}  // namespace servoctl::session
