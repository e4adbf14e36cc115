#include "modbus/framing.hpp"

#include <gtest/gtest.h>

#include "modbus/pdu.hpp"

namespace servoctl::modbus {
namespace {

Bytes hex(std::string_view text) { return parse_hex_bytes(text).value(); }

/// Request and answer as a drive's manual prints them, with the line of eds/syntron's manual.
struct Printed {
  int line;
  const char* request;
  const char* answer;
};
constexpr Printed kPrinted[] = {
    {24, "01 06 00 00 00 14 89 C5", "01 06 00 00 00 14 89 C5"},
    {290, "01 01 00 00 00 01 FD CA", "01 01 01 01 90 48"},
    {302, "01 02 00 00 00 01 B9 CA", "01 02 01 00 A1 88"},
    {314, "01 03 10 2E 00 02 A0 C2", "01 03 04 F3 2D 00 0B 18 B9"},
    {326, "01 06 00 33 00 C8 78 53", "01 06 00 33 00 C8 78 53"},
    {354, "01 10 00 30 00 02 04 00 05 00 05 20 B9", "01 10 00 30 00 02 41 C7"},
    {436, "01 06 00 38 00 01 C9 C7", ""},
    {439, "01 03 10 00 00 01 80 CA", ""},
};

TEST(ModbusFraming, HasTheChecksumsOfThePrintedFrames) {
  for (const auto& printed : kPrinted)
    for (const auto* text : {printed.request, printed.answer}) {
      const auto bytes = hex(text);
      if (bytes.empty()) continue;
      const Message message{bytes[0], 0, Bytes(bytes.begin() + 1, bytes.end() - 2)};
      EXPECT_EQ(to_hex(frame(Framing::rtu, message)), text) << printed.line;
    }
}

TEST(ModbusFraming, RequestsAreThosePrinted) {
  EXPECT_EQ(frame(Framing::rtu, {1, 0, write_request(0x0033, 200)}), hex("01 06 00 33 00 C8 78 53"));
  EXPECT_EQ(frame(Framing::rtu, {1, 0, read_request(Function::read_registers, 0x1000, 1)}),
            hex("01 03 10 00 00 01 80 CA"));
  EXPECT_EQ(frame(Framing::rtu, {1, 0, read_request(Function::read_inputs, 0, 1)}),
            hex("01 02 00 00 00 01 B9 CA"));
}

TEST(ModbusFraming, TakesPrintedFramesByteByByte) {
  for (const auto& printed : kPrinted)
    for (const auto side : {Deframer::Expects::requests, Deframer::Expects::answers}) {
      const auto bytes = hex(side == Deframer::Expects::requests ? printed.request : printed.answer);
      Deframer in(Framing::rtu, side);
      for (std::size_t i = 0; i < bytes.size(); ++i) {
        EXPECT_FALSE(in.take()) << printed.line;
        in.push(ByteSpan(bytes).subspan(i, 1));
      }
      const auto message = in.take();
      ASSERT_EQ(message.has_value(), !bytes.empty()) << printed.line;
      if (message) {
        EXPECT_EQ(message->pdu, Bytes(bytes.begin() + 1, bytes.end() - 2));
      }
      EXPECT_EQ(in.take_damaged(), 0U);
    }
}

/// Adapters of RS-485 hear one where the line changes its direction.
TEST(ModbusFraming, AZeroBeforeAnAnswerIsNoPartOfIt) {
  Deframer in(Framing::rtu, Deframer::Expects::answers);
  in.push(hex("00 00"));
  in.push(hex("01 06 00 33 00 C8 78 53 00 01 06 00 33 00 C8 78 53"));
  EXPECT_TRUE(in.take());
  EXPECT_TRUE(in.take());
  EXPECT_FALSE(in.take());
  EXPECT_EQ(in.take_damaged(), 3U);
  Deframer requests(Framing::rtu, Deframer::Expects::requests);
  const auto to_all = frame(Framing::rtu, {0, 0, write_request(0x0033, 200)});
  requests.push(to_all);
  const auto message = requests.take();
  ASSERT_TRUE(message) << "a request to all has the address 0";
  EXPECT_EQ(message->unit, 0);
}

TEST(ModbusFraming, AWrongBitMakesNoMessage) {
  for (std::size_t bit = 0; bit < 7 * 8; ++bit) {
    auto bytes = hex("01 03 02 00 14 B8 4B");
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
    Deframer in(Framing::rtu, Deframer::Expects::answers);
    in.push(bytes);
    in.on_silence();
    EXPECT_FALSE(in.take()) << bit;
    EXPECT_EQ(in.take_damaged(), 7U) << bit;
  }
}

TEST(ModbusFraming, AfterSilenceTheNextMessageIsTaken) {
  Deframer in(Framing::rtu, Deframer::Expects::answers);
  in.push(hex("FF 00 13"));
  in.on_silence();
  in.push(hex("01 03 02 00 14 B8 4B"));
  EXPECT_TRUE(in.take());
  EXPECT_EQ(in.take_damaged(), 3U);
}

TEST(ModbusFraming, ARequestOfAnUnknownFunctionEndsWithSilence) {
  const auto bytes = frame(Framing::rtu, {1, 0, hex("2B 0E 01 00")});
  Deframer in(Framing::rtu, Deframer::Expects::requests);
  in.push(bytes);
  EXPECT_FALSE(in.take());
  in.on_silence();
  const auto message = in.take();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->pdu, hex("2B 0E 01 00"));
}

/// MODBUS over Serial Line V1.02: two characters a byte behind a colon, and the LRC: F7 03 13 89 00 0A
/// has 60.
TEST(ModbusFraming, AsciiIsTextWithItsSum) {
  const auto bytes = frame(Framing::ascii, {0xF7, 0, hex("03 13 89 00 0A")});
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), ":F7031389000A60\r\n");
  Deframer in(Framing::ascii, Deframer::Expects::requests);
  in.push(bytes);
  EXPECT_EQ(in.take(), (Message{0xF7, 0, hex("03 13 89 00 0A")}));
}

TEST(ModbusFraming, AsciiBeginsAnewAtEachColonAndLeavesOutWhatIsNone) {
  const std::string text = "noise:01 03:F7031389000A60\r\n:F7031389000A61\r\n";
  Deframer in(Framing::ascii, Deframer::Expects::requests);
  in.push(Bytes(text.begin(), text.end()));
  EXPECT_TRUE(in.take());
  EXPECT_FALSE(in.take());
  EXPECT_GT(in.take_damaged(), 5U);
}

/// MODBUS Messaging on TCP/IP V1.0b, 3.1.3.
TEST(ModbusFraming, TcpHasTransactionProtocolLengthAndUnit) {
  const Message message{0x01, 0x1501, hex("03 00 04 00 01")};
  const auto bytes = frame(Framing::tcp, message);
  EXPECT_EQ(to_hex(bytes), "15 01 00 00 00 06 01 03 00 04 00 01");
  Deframer in(Framing::tcp, Deframer::Expects::requests);
  in.push(ByteSpan(bytes).first(7));
  EXPECT_FALSE(in.take());
  in.push(ByteSpan(bytes).subspan(7));
  EXPECT_EQ(in.take(), message);
}

TEST(ModbusFraming, AStreamThatIsNoModbusIsBroken) {
  const std::string text = "SSH-2.0-OpenSSH_9.2\r\n";
  Deframer in(Framing::tcp, Deframer::Expects::answers);
  in.push(Bytes(text.begin(), text.end()));
  EXPECT_TRUE(in.broken());
  EXPECT_FALSE(in.take());
}

TEST(ModbusFraming, NoiseThatNeverEndsIsNotKept) {
  Deframer in(Framing::rtu, Deframer::Expects::answers);
  for (int i = 0; i < 1000; ++i) in.push(hex("01 2B 55"));
  EXPECT_LT(3000U - in.take_damaged(), 600U);
}

TEST(ModbusPdu, AnAnswerFitsItsRequestAlone) {
  const auto read = read_request(Function::read_registers, 0x33, 1);
  EXPECT_EQ(fit(read, hex("03 02 00 C8")), Fit::answer);
  EXPECT_EQ(fit(read, hex("83 02")), Fit::exception);
  EXPECT_EQ(fit(read, hex("03 04 00 C8 00 00")), Fit::malformed);
  EXPECT_EQ(fit(read, hex("03 02 00")), Fit::malformed);
  EXPECT_EQ(fit(read, hex("06 00 33 00 C8")), Fit::other);
  const auto write = write_request(0x33, 200);
  EXPECT_EQ(fit(write, hex("06 00 33 00 C8")), Fit::answer);
  EXPECT_EQ(fit(write, hex("06 00 33 00 C9")), Fit::other);
  EXPECT_EQ(fit(write, hex("06 00 34 00 C8")), Fit::other);
  EXPECT_EQ(fit(write, hex("86 03")), Fit::exception);
  EXPECT_EQ(fit(read_request(Function::read_inputs, 0, 8), hex("02 01 03")), Fit::answer);
}

}  // namespace
}  // namespace servoctl::modbus
