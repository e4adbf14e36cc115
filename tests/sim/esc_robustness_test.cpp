// Whatever comes in, a simulated slave stays within its memory and goes on: the sanitizers see the rest.
#include <random>

#include "esc_support.hpp"

namespace servoctl::sim {
namespace {

class EscRobustness : public EscTest {
 protected:
  std::uint32_t any(std::uint32_t below) { return static_cast<std::uint32_t>(random_() % below); }
  Bytes any_bytes(std::size_t most) {
    Bytes out(any(static_cast<std::uint32_t>(most) + 1));
    for (auto& byte : out) byte = static_cast<std::uint8_t>(any(4) == 0 ? any(256) : any(8));
    return out;
  }
  /// The station answers still, and comes to PRE-OP.
  void expect_it_works() {
    ring_.power_off(0);
    ring_.power_on(0, now_);
    counter_ = 0;
    EXPECT_EQ(datagram(kApwr, 0x0010'0000, store_le(kStation, 2)).counter, 1);
    go_to_pre_op();
    EXPECT_EQ(sdo("40 0010 00 00000000"), "00 30 43 00 10 00 92 01 04 00");
  }

  std::mt19937 random_{20};
};

TEST_F(EscRobustness, SurvivesAnyDatagram) {
  build(1);
  const std::uint16_t places[] = {0x0000, 0x0100, 0x0120, 0x0300, 0x0500, 0x0600, 0x0800,
                                  0x0900, 0x0980, 0x1000, 0x1400, 0x1800, 0x2FF0, 0xFFF0};
  for (int i = 0; i < 20000; ++i) {
    const auto place = static_cast<std::uint16_t>(places[any(std::size(places))] + any(32));
    const bool logical = any(4) == 0;
    const auto address =
        logical ? any(0x200) : static_cast<std::uint32_t>(place) << 16U | (any(3) != 0 ? 0U : kStation);
    (void)send(frame_of(
        {datagram_of(static_cast<std::uint8_t>(any(16)), address, any_bytes(any(10) == 0 ? 1400 : 40))}));
    if (any(50) == 0) run(std::chrono::milliseconds(any(150)));
  }
  expect_it_works();
}

TEST_F(EscRobustness, SurvivesAnyFrame) {
  build(2);
  for (int i = 0; i < 20000; ++i) {
    auto frame = any_bytes(100);
    if (frame.size() > 20 && any(4) != 0) {
      frame[12] = 0x88;
      frame[13] = 0xA4;
      frame[15] = 0x10;
    }
    (void)send(frame);
  }
  expect_it_works();
}

TEST_F(EscRobustness, SurvivesAnyMessageInItsMailbox) {
  load();
  options_.coe.sdo_info = true;
  options_.coe.complete_access = true;
  build(1);
  go_to_pre_op();
  for (int i = 0; i < 5000; ++i) {
    auto message = any_bytes(any(4) == 0 ? 200 : 20);
    if (message.size() > 1 && any(8) != 0) message[1] = any(4) == 0 ? 0x80 : 0x20;
    if (message.size() > 4 && any(2) == 0) {  // An object that is there.
      const auto objects = profile_->dictionary.objects();
      store_le(objects[any(static_cast<std::uint32_t>(objects.size()))].index,
               std::span(message).subspan(3, 2));
    }
    (void)post(message, static_cast<std::uint8_t>(any(10) == 0 ? any(16) : 3));
    while (!fetch().empty()) continue;
  }
  expect_it_works();
}

}  // namespace
}  // namespace servoctl::sim
