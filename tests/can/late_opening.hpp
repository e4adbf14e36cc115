#pragma once

#include <gtest/gtest.h>

#include <chrono>

#include "can/bus.hpp"

namespace servoctl::can {

/// Recovers a lost bus as a waiting program does, a little at a time, until it is open: how often. Each ends
/// by its deadline although the opening goes on, and until it is done nothing can be sent.
inline int recoveries_until_open(Bus& bus, const Frame& frame) {
  Result<void> back = fail(Errc::bus, "");
  int tries = 0;
  for (; tries < 200 && !back; ++tries) {
    const auto begin = bus.now();
    back = bus.recover(begin + std::chrono::milliseconds(20));
    EXPECT_LT(bus.now() - begin, std::chrono::milliseconds(250)) << "it ends by its deadline";
    if (!back) {
      EXPECT_FALSE(bus.send(frame)) << "it is not open yet";
    }
  }
  EXPECT_TRUE(back);
  return tries;
}

}  // namespace servoctl::can
