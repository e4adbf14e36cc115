#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/bytes.hpp"
#include "can/local.hpp"

namespace servoctl::can {

inline Frame frame_of(const char* text) { return parse_frame(text).value(); }
inline Frame numbered(std::uint32_t id, std::uint32_t number) { return make_frame(id, store_le(number, 4)); }

/// Waits, but not for ever when the code is broken.
inline std::optional<Frame> next(Bus& bus) {
  return bus.receive(bus.now() + std::chrono::seconds(20)).value();
}
/// What is there without waiting.
inline std::optional<Frame> now_at(Bus& bus) { return bus.receive(bus.now()).value(); }

/// A runtime directory of its own for each test.
class LocalBusTest : public testing::Test {
 protected:
  LocalBusTest() {
    std::string name = testing::TempDir() + "servoctl-local-XXXXXX";
    runtime_ = ::mkdtemp(name.data());
    ::setenv("XDG_RUNTIME_DIR", runtime_.c_str(), 1);
  }
  ~LocalBusTest() override {
    ::unsetenv("XDG_RUNTIME_DIR");
    std::filesystem::remove_all(runtime_);
  }

  static std::unique_ptr<Bus> join(const char* name = "demo", Duration patience = std::chrono::seconds(20)) {
    auto bus = open_local(name, patience);
    EXPECT_TRUE(bus) << bus.error().message.text();
    return std::move(*bus);
  }

  std::filesystem::path directory() const { return runtime_ / "servoctl" / "bus-demo"; }

  std::size_t member_files() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(directory()))
      count += entry.path().filename().string().starts_with("member-") ? 1U : 0U;
    return count;
  }

  std::filesystem::path runtime_;
};

}  // namespace servoctl::can
