#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <string_view>

#include "base/duration.hpp"
#include "base/time.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {

/// Plays a dialogue against a machine that speaks through a mailbox, messages without the mailbox's header:
/// `> 0020 40…` is what it must send, `< 0030 43…` what it is told, `+ 500ms` lets time pass. What it sends
/// beyond the dialogue is a failure.
template <class Machine>
void play(Machine& machine, TimePoint& now, std::initializer_list<std::string_view> lines) {
  for (const auto line : lines) {
    const auto rest = line.substr(2);
    if (line.front() == '>') {
      const auto sent = machine.take_message();
      ASSERT_TRUE(sent) << "nothing was sent, expected " << line;
      EXPECT_EQ(to_hex(*sent, ""), to_hex(hex(rest), ""));
    } else if (line.front() == '<') {
      now += std::chrono::milliseconds(1);
      machine.on_message(hex(rest), now);
    } else {
      now += parse_duration(rest).value();
      machine.on_time(now);
    }
  }
  const auto more = machine.take_message();
  EXPECT_FALSE(more) << "sent beyond the dialogue: " << to_hex(*more, "");
}

}  // namespace servoctl::ethercat
