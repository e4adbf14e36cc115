#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <string_view>

#include "base/duration.hpp"
#include "can/frame.hpp"

namespace servoctl::canopen {

inline can::Frame frame(std::string_view text) {
  const auto parsed = can::parse_frame(text);
  EXPECT_TRUE(parsed) << text;
  return parsed.value_or(can::Frame{});
}

/// Plays a transcript in candump notation against a machine: `> 602#…` is what it must send, `< 582#…` what
/// it is told,
/// `+ 500ms` lets time pass. What it sends beyond the transcript is a failure.
template <class Machine>
void play(Machine& machine, TimePoint& now, std::initializer_list<std::string_view> lines) {
  for (const auto line : lines) {
    const auto rest = line.substr(2);
    if (line.front() == '>') {
      const auto sent = machine.take_frame();
      ASSERT_TRUE(sent) << "nothing was sent, expected " << line;
      EXPECT_EQ(can::to_string(*sent), rest);
    } else if (line.front() == '<') {
      now += std::chrono::milliseconds(1);
      machine.on_frame(frame(rest), now);
    } else {
      now += parse_duration(rest).value();
      machine.on_time(now);
    }
  }
  const auto more = machine.take_frame();
  EXPECT_FALSE(more) << "sent beyond the transcript: " << can::to_string(*more);
}

}  // namespace servoctl::canopen
