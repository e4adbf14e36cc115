#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/time.hpp"

namespace servoctl::canopen {

/// The 8 bytes of SDO, on CAN and over EtherCAT.
using SdoBytes = std::array<std::uint8_t, 8>;

/// A server of SDO that does at once what it is asked, in order, and answers as late, as often or as rarely
/// as a test wants; answers do not overtake each other.
class SlowServer {
 public:
  struct Answering {
    Duration delay = std::chrono::milliseconds(1);
    int copies = 1;  ///< 0: the answer is lost.
    bool refuses = false;
  };
  struct Write {
    TimePoint time;
    std::uint8_t value;
  };

  std::function<Answering()> next = [] { return Answering{}; };
  std::map<ObjectAddress, std::vector<Write>> values;  ///< In order of time.

  void set(ObjectAddress object, std::uint8_t value, TimePoint now) {
    values[object].push_back({now, value});
  }
  /// Whether the object had the value at `from` or later.
  bool had(ObjectAddress object, std::uint8_t value, TimePoint from) {
    const auto& all = values[object];
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool holds_later = i + 1 == all.size() || all[i + 1].time >= from;
      if (all[i].value == value && holds_later) return true;
    }
    return false;
  }

  void on_request(const SdoBytes& request, TimePoint now) {
    if (request[0] == 0x80) return;
    const ObjectAddress object{static_cast<std::uint16_t>(request[1] | request[2] << 8), request[3]};
    const auto how = next();
    SdoBytes answer{0, request[1], request[2], request[3]};
    if (how.refuses) {
      answer = {0x80, request[1], request[2], request[3], 0x22, 0x00, 0x00, 0x08};
    } else if (request[0] == 0x40) {
      answer[0] = 0x4F;
      answer[4] = values[object].empty() ? 0 : values[object].back().value;
    } else {
      answer[0] = 0x60;
      set(object, request[4], now);
    }
    auto time = now + how.delay;
    if (!coming.empty()) time = std::max(time, coming.back().first);
    for (int i = 0; i < how.copies; ++i) coming.emplace_back(time, answer);
  }

  std::deque<std::pair<TimePoint, SdoBytes>> coming;
};

}  // namespace servoctl::canopen
