#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "sim/cell.hpp"

namespace servoctl::sim {

/// The drives of `spec` on a bus with virtual time, made from the project's own data.
class CellTest : public testing::Test {
 protected:
  void build(std::string_view spec) {
    const std::filesystem::path folders[] = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};
    auto cell = build_cell(spec, folders, bus.now());
    ASSERT_TRUE(cell) << cell.error().message;
    cell_ = std::move(*cell);
    for (const auto& drive : cell_.drives) bus.attach(*drive);
  }

  SimDrive& drive(std::size_t i = 0) { return *cell_.drives[i]; }

  void send(std::string_view frame) {
    const auto parsed = can::parse_frame(frame);
    ASSERT_TRUE(parsed) << frame;
    ASSERT_TRUE(bus.send(*parsed));
  }

  /// The next frame within `patience`, in candump notation; empty when none comes.
  std::string next(Duration patience = std::chrono::milliseconds(0)) {
    const auto frame = bus.receive(bus.now() + patience);
    return frame && *frame ? can::to_string(**frame) : std::string();
  }

  /// Sends a request and gives the answer; PDOs that come in between are left out.
  std::string ask(std::string_view frame) {
    send(frame);
    auto answer = next();
    while (answer >= "181#" && answer < "580#") answer = next();
    return answer;
  }

  Cell cell_;
  SimBus bus{SimBus::Clock::virtual_time};
};

}  // namespace servoctl::sim
