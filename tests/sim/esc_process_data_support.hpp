#pragma once

#include "esc_support.hpp"

namespace servoctl::sim {

inline constexpr Duration kCycle = std::chrono::milliseconds(4);

/// The outputs of 1702h and the inputs of 1B04h, by their places in a datagram of 48 bytes.
struct Outputs {
  std::uint16_t controlword = 0;
  std::int32_t position = 0;
  std::int32_t velocity = 0;
  std::int16_t torque = 0;
  std::int8_t mode = 0;
  std::uint16_t probe = 0;
  std::uint32_t max_velocity = 0;
};

/// One drive whose process data are 1702h and 1B04h, at logical 00010000h.
class EscProcessDataTest : public EscTest {
 protected:
  void start() {
    build(1);
    go_to_pre_op();
    for (const auto* request :
         {"2B 121C 01 0217 0000", "2F 121C 00 01000000", "2B 131C 01 041B 0000", "2F 131C 00 01000000"})
      EXPECT_EQ(sdo(request).substr(6, 2), "60") << request;
    EXPECT_EQ(write(0x0810, "0018 1300 64 00 01 00 001C 1D00 20 00 01 00"), 1);
    EXPECT_EQ(
        write(0x0600, "00000100 1300 00 07 0018 00 02 01 000000 13000100 1D00 00 07 001C 00 01 01 000000"),
        1);
    ASSERT_EQ(request(4), "04 00 00 00 00 00");
  }
  void start_op() {
    start();
    EXPECT_EQ(exchange(), 3);
    ASSERT_EQ(request(8), "08 00 00 00 00 00");
  }
  /// One cycle; its working counter.
  int exchange() {
    Bytes image;
    const auto add = [&](std::int64_t value, std::size_t size) {
      const auto bytes = store_le(static_cast<std::uint64_t>(value), size);
      image.insert(image.end(), bytes.begin(), bytes.end());
    };
    add(out.controlword, 2);
    add(out.position, 4);
    add(out.velocity, 4);
    add(out.torque, 2);
    add(out.mode, 1);
    add(out.probe, 2);
    add(out.max_velocity, 4);
    image.resize(48);
    const auto got = datagram(kLrw, 0x0001'0000, image);
    if (got.counter > 0) in_.assign(got.data.begin() + 19, got.data.end());
    return got.counter;
  }
  void cycle(Duration time) {
    for (const auto end = now_ + time; now_ < end;) {
      run(kCycle);
      EXPECT_EQ(exchange(), 3);
    }
  }
  std::uint64_t in(std::size_t at, std::size_t size) const {
    return load_le(ByteSpan(in_).subspan(at, size));
  }
  unsigned statusword() const { return static_cast<unsigned>(in(2, 2)); }
  std::int32_t position() const { return static_cast<std::int32_t>(in(4, 4)); }
  std::int32_t velocity() const { return static_cast<std::int32_t>(in(25, 4)); }
  /// What the drive has now, so that nothing changes when the image is taken over.
  void preset() {
    const auto& values = slave().model().values();
    out.position = static_cast<std::int32_t>(values.number({0x6064, 0}));
    out.mode = 3;
    out.probe = static_cast<std::uint16_t>(values.number({0x60B8, 0}));
    out.max_velocity = static_cast<std::uint32_t>(values.number({0x607F, 0}));
  }
  void enable() {
    for (const std::uint16_t word : {std::uint16_t{6}, std::uint16_t{7}, std::uint16_t{15}}) {
      out.controlword = word;
      cycle(3 * kCycle);
    }
    ASSERT_EQ(statusword() & 0x6FU, 0x27U);
  }

  Outputs out;
  Bytes in_;
};

}  // namespace servoctl::sim
