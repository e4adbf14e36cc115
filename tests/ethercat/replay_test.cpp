#include <gtest/gtest.h>

#include <vector>

#include "ethercat/coe_slave.hpp"
#include "ethercat/registers.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

// Conversations of another master with real slaves, byte by byte: captures of ethercrab (MIT or Apache-2.0).
// What the master must write is compared, what the slave answered is given to it; how often it looks at the
// mailboxes in between is its own.
struct Exchange {
  std::string_view written;  ///< The beginning of SM0; the rest is zeros.
  std::string_view answered;
};

/// Answers as it is written, and fails when it is asked something else.
class Recorded {
 public:
  Recorded(std::vector<Exchange> script, SiiMailbox place, std::uint16_t station)
      : script_(std::move(script)),
        place_(place),
        coe_(1, SlaveAddress::station(station), Mailbox::Options{place}, 500ms) {
    coe_.mailbox().start(now_);
  }
  CoeClient& client() { return coe_.client(); }
  TimePoint now() const { return now_; }

  Result<Bytes> finish() {
    for (int steps = 0; steps < 10'000; ++steps) {
      coe_.serve(ring_, now_);
      if (auto result = client().take_result()) return *result;
      if (const auto frame = ring_.take_frame(now_)) {
        Bytes bytes(frame->begin(), frame->end());
        answer(bytes);
        now_ += 500us;
        ring_.on_frame(bytes, now_);
      } else {
        now_ = std::max(now_ + 1us, coe_.deadline());
        coe_.on_time(now_);
      }
    }
    return fail(Errc::bug, "no end");
  }
  bool is_over() const { return at_ == script_.size() && !full_; }

 private:
  void answer(Bytes& frame) {
    auto reader = FrameReader::open(frame);
    while (const auto datagram = reader->next()) {
      auto data = data_of(frame, *datagram);
      set_working_counter(frame, *datagram, 1);
      if (datagram->ado() == place_.out_start) {
        ASSERT_LT(at_, script_.size());
        auto expected = hex(script_[at_].written);
        expected.resize(place_.out_size);
        EXPECT_EQ(to_hex(datagram->data, ""), to_hex(expected, "")) << "exchange " << at_;
        full_ = true;
      } else if (datagram->ado() == place_.in_start) {
        const auto box = hex(script_[at_++].answered);
        std::copy(box.begin(), box.end(), data.begin());
        full_ = false;
      } else {
        EXPECT_EQ(datagram->ado(), reg::sm_status(0));
        data[8] = full_ ? reg::kSmFull : std::uint8_t{0};
      }
    }
  }

  std::vector<Exchange> script_;
  SiiMailbox place_;
  std::size_t at_ = 0;
  bool full_ = false;
  Ring ring_{Ring::Options{}};
  CoeSlave coe_;
  TimePoint now_{1s};
};

TEST(Replay, AnAssignmentOfPdosIsWrittenAndReadBackAsInTheCapture) {
  // EK1914 in tests/replay-ek1914-el3004-configure.pcapng, frames 954 to 1104.
  Recorded slave({{"0A00000000 13 00202F121C0000000000", "0A00000000 13 003060121C0000000000"},
                  {"0A00000000 23 00202F131C0000000000", "0A00000000 23 003060131C0000000000"},
                  {"0A00000000 33 00202B131C01001A0000", "0A00000000 33 003060131C01001A0000"},
                  {"0A00000000 43 00202B131C02021A0000", "0A00000000 43 003060131C02021A0000"},
                  {"0A00000000 53 00202B131C03041A0000", "0A00000000 53 003060131C03041A0000"},
                  {"0A00000000 63 00202B131C04061A0000", "0A00000000 63 003060131C04061A0000"},
                  {"0A00000000 73 00202F131C0004000000", "0A00000000 73 003060131C0004000000"},
                  {"0A00000000 13 002040131C0100000000", "0A00000000 13 00304B131C01001A0000"},
                  {"0A00000000 23 002040131C0200000000", "0A00000000 23 00304B131C02021A0000"},
                  {"0A00000000 33 002040131C0300000000", "0A00000000 33 00304B131C03041A0000"},
                  {"0A00000000 43 002040131C0400000000", "0A00000000 43 00304B131C04061A0000"},
                  {"0A00000000 53 002040131C0000000000", "0A00000000 53 00304F131C0004000000"}},
                 {0x1000, 128, 0x1080, 128}, 0x1001);
  const auto write = [&](ObjectAddress object, Bytes data) {
    slave.client().start_download(object, std::move(data), slave.now());
    EXPECT_TRUE(slave.finish());
  };
  const auto read = [&](ObjectAddress object) {
    slave.client().start_upload(object, slave.now());
    return to_hex(slave.finish().value_or(Bytes{}));
  };
  write({0x1C12, 0}, {0});
  write({0x1C13, 0}, {0});
  for (std::uint8_t sub = 1; sub <= 4; ++sub)
    write({0x1C13, sub}, {static_cast<std::uint8_t>(2 * (sub - 1)), 0x1A});
  write({0x1C13, 0}, {4});
  EXPECT_EQ(read({0x1C13, 1}), "00 1A");
  EXPECT_EQ(read({0x1C13, 2}), "02 1A");
  EXPECT_EQ(read({0x1C13, 3}), "04 1A");
  EXPECT_EQ(read({0x1C13, 4}), "06 1A");
  EXPECT_EQ(read({0x1C13, 0}), "04");
  EXPECT_TRUE(slave.is_over());
}

TEST(Replay, MappingsAreReadAtOnceAsInTheCapture) {
  // A LAN9252 board in dumps/soem-single-lan9252.pcapng, frames 302 to 626. Its answer to 1C12h says 4 bytes,
  // no size.
  Recorded slave(
      {{"0A00000000 13 002050001C0000000000", "1000000000 13 003051001C0006000000040001020304"},
       {"0A00000000 23 002050121C0000000000", "0A00000000 23 003053121C0001000116"},
       {"0A00000000 33 00205001160000000000",
        "3000000000 33 0030510116002600000009000101107001021070010310700104107001051070010610700107107001"
        "08107008000000"}},
      {0x1000, 128, 0x1080, 128}, 0x1001);
  const auto read = [&](std::uint16_t index) {
    slave.client().start_upload({index, 0}, slave.now(), canopen::Transfer::automatic, true);
    return to_hex(slave.finish().value_or(Bytes{}), "");
  };
  EXPECT_EQ(read(0x1C00), "040001020304");
  EXPECT_EQ(read(0x1C12), "01000116");
  EXPECT_EQ(read(0x1601),
            "0900"
            "01011070"
            "01021070"
            "01031070"
            "01041070"
            "01051070"
            "01061070"
            "01071070"
            "01081070"
            "08000000");
  EXPECT_TRUE(slave.is_over());
}

TEST(Replay, ANameIsReadInOneAnswerAsInTheCapture) {
  // EK1914 in tests/replay-ek1914-segmented-upload.pcapng, frames 956 and 964.
  Recorded slave({{"0A00000000 13 00204008100000000000", "1000000000 13 00304108100006000000454B31393134"}},
                 {0x1000, 256, 0x1100, 256}, 0x1000);
  slave.client().start_upload({0x1008, 0}, slave.now());
  const auto name = slave.finish();
  ASSERT_TRUE(name);
  EXPECT_EQ(std::string(name->begin(), name->end()), "EK1914");
}

}  // namespace
}  // namespace servoctl::ethercat
