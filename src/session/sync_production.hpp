#pragma once

#include "base/rhythm.hpp"
#include "canopen/sync.hpp"

namespace servoctl::session {

/// servoctl as SYNC producer, and how evenly it is one.
struct SyncProduction {
  canopen::SyncProducer::Options options;
  canopen::SyncProducer producer;
  Rhythm rhythm = {};
};

}  // namespace servoctl::session
