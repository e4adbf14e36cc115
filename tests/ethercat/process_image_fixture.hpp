#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <vector>

#include "ethercat/process_image.hpp"
#include "hex.hpp"
#include "process_slave.hpp"

namespace servoctl::ethercat {
inline constexpr ObjectAddress kControl{0x6040, 0};
inline constexpr ObjectAddress kTarget{0x607A, 0};
inline constexpr ObjectAddress kMode{0x6060, 0};
inline constexpr ObjectAddress kFlag{0x2000, 1};
inline constexpr ObjectAddress kStatus{0x6041, 0};
inline constexpr ObjectAddress kActual{0x6064, 0};
inline constexpr ObjectAddress kBit{0x2001, 2};

inline ProcessMapping mapping() {
  return {{{kControl, 16}, {kTarget, 32}, {kFlag, 1}, {{0x0001, 0}, 3}, {kMode, 8}, {{0x0001, 0}, 4}},
          {{kStatus, 16}, {kBit, 1}, {{0x0001, 0}, 7}, {kActual, 32}}};
}

class ProcessImageTest : public testing::Test {
 protected:
  explicit ProcessImageTest(std::size_t slaves = 2, bool lrw = true) {
    for (std::size_t i = 0; i < slaves; ++i) {
      const auto number = static_cast<std::uint8_t>(i + 1);
      wire.emplace_back(static_cast<std::uint16_t>(0x1000 + number));
      const auto logical = image.add(number, mapping(), lrw);
      const auto plan = plan_slave(number, {2, 0x1100, 0x64, 3, 0x1200, 0x20}, mapping(), logical);
      for (const auto& request :
           plan->requests(SlaveAddress::station(static_cast<std::uint16_t>(0x1000 + number))))
        std::copy(request.data.begin(), request.data.end(),
                  wire.back().memory.begin() + (request.address >> 16));
    }
  }
  void preset() {
    for (std::uint8_t node = 1; node <= wire.size(); ++node) {
      ASSERT_TRUE(image.set(node, kControl, hex("0600")));
      ASSERT_TRUE(image.set(node, kTarget, hex("78563412")));
      ASSERT_TRUE(image.set(node, kFlag, hex("01")));
      ASSERT_TRUE(image.set(node, kMode, hex("03")));
    }
  }
  void send(bool lost = false) {
    while (const auto frame = ring.take_frame(now)) {
      ++frames;
      Bytes bytes(frame->begin(), frame->end());
      auto reader = FrameReader::open(*frame);
      while (const auto datagram = reader->next()) {
        unsigned counter = 0;
        for (auto& slave : wire) counter += slave.pass(*datagram, data_of(bytes, *datagram));
        set_working_counter(bytes, *datagram, says.value_or(static_cast<std::uint16_t>(counter)));
      }
      if (!lost) arriving.push_back(std::move(bytes));
    }
  }
  void arrive() {
    for (; !arriving.empty(); arriving.pop_front()) ring.on_frame(arriving.front(), now);
    image.serve(ring, now);
  }
  /// One cycle to its end.
  void cycle(bool lost = false) {
    if (image.running()) now = std::max(now, image.deadline());
    ring.on_time(now);
    image.serve(ring, now);
    send(lost);
    now += std::chrono::microseconds(100);
    arrive();
  }
  std::string output_memory(std::size_t slave) {
    return to_hex(ByteSpan(wire[slave].memory).subspan(0x1100, 8));
  }

  std::vector<ProcessSlave> wire;
  ProcessImage image{ProcessImage::Options{}};
  Ring ring{Ring::Options{}};
  TimePoint now{std::chrono::seconds(1)};
  std::deque<Bytes> arriving;
  int frames = 0;
  std::optional<std::uint16_t> says;  ///< The working counter that comes back, whatever was done.
};

}  // namespace servoctl::ethercat
