#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "traffic/link_findings.hpp"

namespace servoctl::traffic {

using Codes = std::vector<std::string>;

/// An interface on which nothing is to be found.
inline LinkFacts facts(std::uint16_t tx = 0, std::uint16_t rx = 0,
                       can::LinkHealth health = can::LinkHealth::error_active) {
  LinkFacts out;
  out.name = "can0";
  out.state.kind = "can";
  out.state.up = true;
  out.state.bitrate = 500'000;
  out.state.sample_point = 875;
  out.state.restart_ms = 100;
  out.state.queue_length = 1000;
  out.state.tx_errors = tx;
  out.state.rx_errors = rx;
  out.state.health = health;
  out.before = out.state;
  out.may_change = true;
  return out;
}

/// The notes and faults; each says what it means and what mends it.
inline Codes codes(const std::vector<Finding>& findings) {
  Codes out;
  for (const auto& f : findings) {
    if (f.level == Finding::Level::ok) continue;
    out.push_back(f.code);
    EXPECT_FALSE(f.means.empty()) << f.code;
    EXPECT_FALSE(f.mend.empty()) << f.code;
  }
  return out;
}

inline const Finding* finding(const std::vector<Finding>& all, std::string_view code) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Finding& f) { return f.code == code; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace servoctl::traffic
