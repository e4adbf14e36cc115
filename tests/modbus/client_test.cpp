#include "modbus/client.hpp"

#include <gtest/gtest.h>

namespace servoctl::modbus {
namespace {

using std::chrono::milliseconds;

constexpr TimePoint kStart{std::chrono::seconds(1)};
constexpr Duration kTimeout = milliseconds(100);

Bytes answer_of(std::uint8_t unit, std::string_view pdu) {
  return frame(Framing::rtu, {unit, 0, parse_hex_bytes(pdu).value()});
}

class ModbusClient : public testing::Test {
 protected:
  ModbusClient() { client.set_silence(milliseconds(10)); }
  Bytes ask(TimePoint now) {
    return client.start(1, read_request(Function::read_registers, 0x33, 1), now, kTimeout);
  }
  Outcome outcome() {
    auto out = client.take_outcome();
    EXPECT_TRUE(out);
    return out.value_or(Outcome{});
  }

  Client client{Framing::rtu};
};

TEST_F(ModbusClient, GivesTheAnswerOfItsUnit) {
  ask(kStart);
  client.on_bytes(answer_of(1, "03 02 00 C8"), kStart + milliseconds(5));
  const auto out = outcome();
  EXPECT_EQ(out.kind, Outcome::Kind::answered);
  EXPECT_EQ(to_hex(out.pdu), "03 02 00 C8");
  EXPECT_FALSE(client.busy());
}

TEST_F(ModbusClient, KeepsTheSilenceBeforeTheNextRequest) {
  ask(kStart);
  client.on_bytes(answer_of(1, "03 02 00 C8"), kStart + milliseconds(5));
  EXPECT_EQ(client.free_at(1), kStart + milliseconds(15));
  EXPECT_EQ(client.free_at(2), kStart + milliseconds(15));
}

TEST_F(ModbusClient, AnAnswerOfAnotherUnitIsNotTaken) {
  ask(kStart);
  client.on_bytes(answer_of(3, "03 02 00 C8"), kStart + milliseconds(5));
  EXPECT_TRUE(client.busy());
  client.on_time(kStart + kTimeout);
  const auto out = outcome();
  EXPECT_EQ(out.kind, Outcome::Kind::silent);
  EXPECT_EQ(out.other_unit, 3);
}

TEST_F(ModbusClient, AUnitThatWasSilentIsGivenAsLongAgainBeforeItIsAskedAnew) {
  ask(kStart);
  client.on_time(kStart + kTimeout);
  EXPECT_EQ(outcome().kind, Outcome::Kind::silent);
  EXPECT_EQ(client.free_at(1), kStart + 2 * kTimeout);
  EXPECT_LE(client.free_at(2), kStart + kTimeout);
}

TEST_F(ModbusClient, ALateAnswerIsNoneToTheNextRequest) {
  ask(kStart);
  client.on_time(kStart + kTimeout);
  (void)outcome();
  client.on_bytes(answer_of(1, "03 02 00 C8"), kStart + kTimeout + milliseconds(20));
  ask(kStart + 2 * kTimeout);
  EXPECT_TRUE(client.busy());
  EXPECT_FALSE(client.take_outcome());
}

TEST_F(ModbusClient, AfterItsAskerWentAnAnswerMayStillCome) {
  ask(kStart);
  client.abandon();
  EXPECT_FALSE(client.busy());
  EXPECT_EQ(client.free_at(1), kStart + 2 * kTimeout);
}

TEST(ModbusException, SettlesNothingWhereTheUnitIsAtItOrNobodyHeard) {
  for (const int open : {0x05, 0x06, 0x0A, 0x0B})
    EXPECT_TRUE(is_open(static_cast<std::uint8_t>(open))) << open;
  for (const int done : {0x01, 0x02, 0x03, 0x04, 0x08})
    EXPECT_FALSE(is_open(static_cast<std::uint8_t>(done))) << done;
}

TEST_F(ModbusClient, CountsWhatIsNoMessage) {
  ask(kStart);
  auto bytes = answer_of(1, "03 02 00 C8");
  bytes[3] ^= 1;
  client.on_bytes(bytes, kStart + milliseconds(5));
  client.on_time(kStart + kTimeout);
  const auto out = outcome();
  EXPECT_EQ(out.kind, Outcome::Kind::silent);
  EXPECT_EQ(out.damaged, 7U);
}

TEST_F(ModbusClient, BurstsOfAnAdapterAreOneMessage) {
  ask(kStart);
  const auto bytes = answer_of(1, "03 02 00 C8");
  client.on_bytes(ByteSpan(bytes).first(3), kStart + milliseconds(5));
  client.on_time(kStart + milliseconds(20));
  client.on_bytes(ByteSpan(bytes).subspan(3), kStart + milliseconds(21));
  EXPECT_EQ(outcome().kind, Outcome::Kind::answered);
}

TEST_F(ModbusClient, TheEchoOfAnAdapterIsLeftOut) {
  const auto sent = ask(kStart);
  client.on_bytes(sent, kStart + milliseconds(1));
  EXPECT_FALSE(client.take_outcome());
  client.on_bytes(answer_of(1, "03 02 00 C8"), kStart + milliseconds(5));
  const auto out = outcome();
  EXPECT_EQ(out.kind, Outcome::Kind::answered);
  EXPECT_TRUE(out.echoed);
}

/// What was sent is the answer to a write: where an adapter hands back what it sends, that is not taken for
/// it.
TEST_F(ModbusClient, AnEchoIsNoAcknowledgeOfAWrite) {
  const auto sent = ask(kStart);
  auto both = sent;
  const auto answer = answer_of(1, "03 02 00 C8");
  both.insert(both.end(), answer.begin(), answer.end());
  client.on_bytes(both, kStart + milliseconds(5));
  (void)outcome();
  const auto write = client.start(1, write_request(0x33, 200), kStart + milliseconds(20), kTimeout);
  client.on_bytes(write, kStart + milliseconds(21));
  EXPECT_FALSE(client.take_outcome());
  client.on_bytes(write, kStart + milliseconds(25));
  EXPECT_EQ(outcome().kind, Outcome::Kind::answered);
}

TEST_F(ModbusClient, AWriteIsAcknowledgedByItsOwnAddressAndValueAlone) {
  client.start(1, write_request(0x33, 200), kStart, kTimeout);
  client.on_bytes(answer_of(1, "06 00 33 00 C9"), kStart + milliseconds(5));
  EXPECT_TRUE(client.busy());
  client.on_time(kStart + kTimeout);
  EXPECT_TRUE(outcome().other_answer);
}

TEST_F(ModbusClient, AnAnswerOfAnotherLengthIsMalformed) {
  ask(kStart);
  client.on_bytes(answer_of(1, "03 04 00 C8 00 00"), kStart + milliseconds(5));
  EXPECT_EQ(outcome().kind, Outcome::Kind::malformed);
}

TEST(ModbusTcpClient, AnAnswerBelongsToItsTransaction) {
  Client client(Framing::tcp);
  client.start(1, read_request(Function::read_registers, 0x33, 1), kStart, kTimeout);
  client.on_time(kStart + kTimeout);
  EXPECT_EQ(client.take_outcome()->kind, Outcome::Kind::silent);
  EXPECT_LE(client.free_at(1), kStart);
  client.start(1, read_request(Function::read_registers, 0x34, 1), kStart + kTimeout, kTimeout);
  const auto pdu = parse_hex_bytes("03 02 00 C8").value();
  client.on_bytes(frame(Framing::tcp, {1, 1, pdu}), kStart + kTimeout);
  EXPECT_TRUE(client.busy());
  client.on_bytes(frame(Framing::tcp, {1, 2, pdu}), kStart + kTimeout);
  EXPECT_EQ(client.take_outcome()->kind, Outcome::Kind::answered);
}

}  // namespace
}  // namespace servoctl::modbus
