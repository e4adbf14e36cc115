#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>

#include "base/bytes.hpp"
#include "drive/quantity.hpp"
#include "sim/cell.hpp"
#include "tests/sim/commissioned.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {

/// Bits of the statusword in positioning and homing.
inline constexpr unsigned kReached = 1U << 10U;
inline constexpr unsigned kError = 1U << 13U;

/// The drives of `spec` on a bus with virtual time, made from the project's own data.
class CellTest : public testing::Test {
 protected:
  void build(std::string_view spec) {
    const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
    auto cell = build_cell(spec, folders, bus.now());
    ASSERT_TRUE(cell) << cell.error().message.text();
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

/// One drive that obeys its bus, and is commanded by SDO.
class DrivenTest : public CellTest {
 protected:
  void boot(const std::string& family) {
    family_ = family;
    build(family + "@1");
    commission(cell_);
    ASSERT_EQ(next(std::chrono::milliseconds(100)), "701#00");
  }
  const drive::Profile& profile() const { return *cell_.profiles.front(); }
  /// As delivered, some drives ignore their limit switches: homing to them does not end.
  void obey_switches() {
    for (const auto& rule : profile().rules.cautions) {
      if (rule.masks.empty() || !rule.set) continue;
      if (const auto* parameter = profile().parameter(rule.name); parameter->object) {
        write(*parameter->object, std::to_string(*rule.set));
        send("000#8101");
        (void)next(std::chrono::milliseconds(500));
      } else {
        drive().panel()[rule.name] = *rule.set;
      }
    }
  }

  /// The answer; what the drive has to say beside it is kept.
  std::string sdo(std::string_view frame) {
    auto answer = ask(frame);
    for (; answer.substr(0, 4) == "081#"; answer = next()) emergency_ = answer;
    return answer;
  }
  void write(ObjectAddress object, std::string_view value) {
    const auto meaning = drive::meaning(drive::target_at(&profile(), object), 1);
    const auto data = od::encode(meaning.type, drive::parse_quantity(meaning, value).value()).value();
    const auto command = data.size() == 1 ? 0x2F : data.size() == 2 ? 0x2B : 0x23;
    char frame[40];
    std::snprintf(frame, sizeof frame, "601#%02X%02X%02X%02X%08X", unsigned(command), object.index & 0xFFU,
                  object.index >> 8U, unsigned{object.sub},
                  static_cast<unsigned>(__builtin_bswap32(static_cast<std::uint32_t>(load_le(data)))));
    EXPECT_EQ(sdo(frame).substr(0, 6), "581#60") << frame;
  }
  std::int32_t read(ObjectAddress object) {
    char frame[40];
    std::snprintf(frame, sizeof frame, "601#40%02X%02X%02X00000000", object.index & 0xFFU, object.index >> 8U,
                  unsigned{object.sub});
    const auto data = parse_hex_bytes(sdo(frame).substr(12)).value();
    const auto type = profile().dictionary.find(object)->type;
    const auto value = od::decode(type, std::span(data).first(od::size_of(type).value()));
    return static_cast<std::int32_t>(od::to_double(value.value()));
  }
  unsigned status() { return static_cast<unsigned>(read({0x6041, 0})); }
  /// Within five seconds.
  bool reaches(unsigned statusword, unsigned mask) {
    for (int i = 0; i < 5000; ++i) {
      if ((status() & mask) == (statusword & mask)) return true;
      (void)next(std::chrono::milliseconds(1));
    }
    return false;
  }
  void enable(std::string_view mode) {
    write({0x6060, 0}, mode);
    for (const auto* word : {"6", "7", "15"}) write({0x6040, 0}, word);
  }
  void wait(Duration time) {
    const auto end = bus.now() + time;
    while (bus.now() < end)
      if (const auto frame = next(end - bus.now()); frame.substr(0, 4) == "081#") emergency_ = frame;
  }

  std::string family_;
  std::string emergency_;  ///< The last one.
};

}  // namespace servoctl::sim
