#include "session/modbus_network.hpp"

#include <gtest/gtest.h>

#include "drive/standard_objects.hpp"
#include "session/modbus_bits.hpp"
#include "session/scan.hpp"
#include "session/session.hpp"
#include "tests/session/modbus_line.hpp"

namespace servoctl::session {
namespace {

using std::chrono::milliseconds;

constexpr ObjectAddress kSpeed{0x2033, 0};
constexpr ObjectAddress kDriveStatus{0x3012, 0};
constexpr std::uint8_t kNodes[] = {1, 2, 3};

Bytes message(std::uint8_t unit, std::string_view pdu) {
  return modbus::frame(modbus::Framing::rtu, {unit, 0, parse_hex_bytes(pdu).value()});
}

drive::ModbusRules rules() {
  drive::ModbusRules out;
  out.registers = {{0x2000, 0x300, 0}, {0x3000, 0x30, 0x1000}};
  out.silence_ms = 10;
  return out;
}

class ModbusNetworkTest : public testing::Test {
 protected:
  ModbusNetworkTest() {
    Options options;
    options.timeout = milliseconds(100);
    auto network = std::make_unique<ModbusNetwork>(std::make_unique<ScriptedLine>(script), "modbus:/dev/x");
    session = std::make_unique<Session>(std::move(network), "modbus:/dev/x", options);
    for (const auto node : kNodes) session->modbus()->learn(node, rules());
  }
  /// Every request gets this PDU from the unit that was asked, after so long.
  void answer_with(std::string pdu, Duration after = milliseconds(5)) {
    script.answer = [=](const Bytes& request) {
      return std::vector{std::pair{after, message(request[0], pdu)}};
    };
  }

  ModbusScript script;
  std::unique_ptr<Session> session;
};

TEST_F(ModbusNetworkTest, AnObjectIsReadFromItsRegister) {
  answer_with("03 02 00 C8");
  EXPECT_EQ(session->upload(1, kSpeed), (Bytes{0xC8, 0x00}));
  EXPECT_EQ(session->upload(1, kDriveStatus), (Bytes{0xC8, 0x00}));
  EXPECT_EQ(script.sent, (std::vector<std::string>{"01 03 00 33 00 01 74 05", "01 03 10 12 00 01 20 CF"}));
}

TEST_F(ModbusNetworkTest, AWriteIsThatOfTheManual) {
  script.answer = [](const Bytes& request) { return std::vector{std::pair{Duration(5000), request}}; };
  EXPECT_TRUE(session->download(1, kSpeed, {0xC8, 0x00}));
  EXPECT_EQ(script.sent, std::vector<std::string>{"01 06 00 33 00 C8 78 53"});
}

TEST_F(ModbusNetworkTest, WhatHasNoRegisterIsRefusedAndNothingIsSent) {
  for (const auto object : {objects::kStatusword, ObjectAddress{0x2033, 1}, ObjectAddress{0x2300, 0}}) {
    const auto read = session->upload(1, object);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, Errc::sdo_abort);
    EXPECT_FALSE(read.error().abort_code);
  }
  EXPECT_TRUE(script.sent.empty());
}

TEST_F(ModbusNetworkTest, AValueOfAnotherWidthIsNotSent) {
  EXPECT_EQ(session->download(1, kSpeed, {1, 0, 0, 0}).error().code, Errc::sdo_abort);
  EXPECT_EQ(session->download(1, kSpeed, {1}).error().code, Errc::sdo_abort);
  EXPECT_TRUE(script.sent.empty());
}

TEST_F(ModbusNetworkTest, WithoutAFamilyThereAreNoObjects) {
  const auto read = session->upload(7, kSpeed);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, Errc::usage);
  EXPECT_NE(read.error().hint.text().find("-d"), std::string::npos);
}

TEST_F(ModbusNetworkTest, AnExceptionIsTheRefusalOfTheDrive) {
  answer_with("83 02");
  const auto read = session->upload(1, kSpeed);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, Errc::sdo_abort);
  EXPECT_EQ(
      read.error().message.text(),
      "node 1, object 0x2033:0: the read of register 0033h was refused: Modbus exception 02h, illegal data "
      "address: it has no such register, or it cannot be written");
}

/// Exception 06h: nothing of the request was done, and the unit wants to be asked again.
TEST_F(ModbusNetworkTest, ABusyUnitIsAskedAgainUntilItAnswers) {
  int left = 3;
  script.answer = [&](const Bytes& request) {
    const bool write = request[1] == 0x06;
    const auto busy = message(request[0], write ? "86 06" : "83 06");
    return std::vector{std::pair{Duration(5000), left-- > 0 ? busy
                                                 : write    ? request
                                                            : message(request[0], "03 02 00 C8")}};
  };
  EXPECT_EQ(session->upload(1, kSpeed), (Bytes{0xC8, 0x00}));
  ASSERT_EQ(script.times.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_GE(script.times[i] - script.times[i - 1], milliseconds(20));
  left = 2;
  EXPECT_TRUE(session->download(1, kSpeed, {0xC8, 0x00}));
  EXPECT_EQ(script.sent.size(), 7U);
}

TEST_F(ModbusNetworkTest, AUnitThatStaysBusyIsGivenUpAfterTheTimeout) {
  answer_with("86 06");
  const auto begun = script.now;
  const auto write = session->download(1, kSpeed, {0xC8, 0x00});
  ASSERT_FALSE(write);
  EXPECT_EQ(write.error().code, Errc::timeout);
  EXPECT_NE(write.error().message.text().find("Modbus exception 06h, server device busy"), std::string::npos)
      << write.error().message.text();
  EXPECT_GE(script.sent.size(), 3U);
  EXPECT_LE(script.now - begun, milliseconds(150));
}

TEST_F(ModbusNetworkTest, AMalformedAnswerIsShownWithItsBytes) {
  answer_with("03 04 00 C8 00 00");
  const auto read = session->upload(1, kSpeed);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, Errc::protocol);
  EXPECT_EQ(read.error().message.text(),
            "node 1, object 0x2033:0: the answer to register 0033h has another length than was asked for: 03 "
            "04 00 C8 00 00");
}

TEST_F(ModbusNetworkTest, OneRequestIsOnTheLineAtATime) {
  answer_with("03 02 00 01", milliseconds(40));
  std::vector<SdoRequest> requests;
  for (const auto node : kNodes) requests.push_back({node, kSpeed, {}});
  for (const auto& answer : session->transfer(requests)) EXPECT_TRUE(answer);
  ASSERT_EQ(script.times.size(), 3U);
  // The answer, then the silence of the family.
  for (std::size_t i = 1; i < 3; ++i) EXPECT_GE(script.times[i] - script.times[i - 1], milliseconds(50));
}

TEST_F(ModbusNetworkTest, ASilentUnitIsAskedAgainAfterAsLongAndOthersNeedNotWait) {
  script.answer = [](const Bytes& request) {
    std::vector<std::pair<Duration, Bytes>> out;
    if (request[0] == 2) out.emplace_back(milliseconds(5), message(2, "03 02 00 01"));
    return out;
  };
  const SdoRequest requests[] = {{1, kSpeed, {}}, {2, kSpeed, {}}};
  const auto answers = session->transfer(requests);
  ASSERT_FALSE(answers[0]);
  EXPECT_EQ(answers[0].error().code, Errc::timeout);
  EXPECT_TRUE(answers[1]);
  ASSERT_EQ(script.sent.size(), 3U);
  EXPECT_EQ(script.sent[1].substr(0, 2), "02");
  EXPECT_GE(script.times[2] - script.times[0], milliseconds(200));
}

/// The answer to a read does not say what it is of: a late one must not be taken for another register's.
TEST_F(ModbusNetworkTest, ALateAnswerIsNotTheValueOfTheNextRegister) {
  unsigned count = 0;
  script.answer = [&](const Bytes& request) {
    const bool first = ++count == 1;
    return std::vector{std::pair{Duration(milliseconds(first ? 150 : 5)),
                                 message(request[0], first ? "03 02 11 11" : "03 02 22 22")}};
  };
  session->options().retries = 0;
  EXPECT_EQ(session->upload(1, kSpeed).error().code, Errc::timeout);
  EXPECT_EQ(session->upload(1, kDriveStatus), (Bytes{0x22, 0x22}));
}

TEST_F(ModbusNetworkTest, DamagedAnswersAreToldAsSuch) {
  session->options().retries = 0;
  script.answer = [](const Bytes&) {
    return std::vector{std::pair{Duration(5000), parse_hex_bytes("FE 80 00 E6 9C").value()}};
  };
  const auto read = session->upload(1, kSpeed);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, Errc::timeout);
  EXPECT_NE(read.error().message.text().find("5 bytes came that are no message"), std::string::npos)
      << read.error().message.text();
  EXPECT_NE(read.error().hint.text().find("parity"), std::string::npos);
}

TEST_F(ModbusNetworkTest, AnAnswerOfAnotherLengthIsAgainstTheProtocol) {
  answer_with("03 04 00 C8 00 00");
  EXPECT_EQ(session->upload(1, kSpeed).error().code, Errc::protocol);
}

TEST_F(ModbusNetworkTest, AnotherUnitIsNamed) {
  session->options().retries = 0;
  script.answer = [](const Bytes&) {
    return std::vector{std::pair{Duration(5000), message(9, "03 02 00 01")}};
  };
  EXPECT_NE(session->upload(1, kSpeed).error().message.text().find("unit 9 answered instead"),
            std::string::npos);
}

TEST_F(ModbusNetworkTest, ALineThatIsLostIsToldAndComesBack) {
  answer_with("03 02 00 01");
  script.lost = true;
  EXPECT_EQ(session->upload(1, kSpeed).error().code, Errc::bus);
  EXPECT_TRUE(session->network().recover(session->now()));
  EXPECT_EQ(script.reopened, 1U);
  EXPECT_TRUE(session->upload(1, kSpeed));
}

TEST_F(ModbusNetworkTest, CtrlCEndsAWait) {
  unsigned asked = 0;
  session->options().cancelled = [&] { return ++asked > 2; };
  EXPECT_EQ(session->upload(1, kSpeed).error().code, Errc::interrupted);
}

TEST_F(ModbusNetworkTest, AScanFindsWhoeverAnswersAnything) {
  script.answer = [](const Bytes& request) {
    std::vector<std::pair<Duration, Bytes>> out;
    if (request[0] == 2) out.emplace_back(milliseconds(5), message(2, "83 02"));
    if (request[0] == 3) out.emplace_back(milliseconds(5), message(3, "03 02 00 00"));
    return out;
  };
  const std::uint8_t nodes[] = {1, 2, 3};
  std::vector<Error> away;
  const auto found = scan(*session, nodes, &away);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].node, 2);
  EXPECT_TRUE((*found)[1].by_registers);
  ASSERT_EQ(away.size(), 1U);
  EXPECT_EQ(away.front().node, 1);
}

TEST_F(ModbusNetworkTest, BitsAreReadByTheirFunctions) {
  answer_with("02 01 05");
  const auto bits = read_inputs(*session, 1, 8);
  ASSERT_TRUE(bits);
  EXPECT_EQ(*bits, (std::vector<bool>{true, false, true, false, false, false, false, false}));
  EXPECT_EQ(script.sent.front(), "01 02 00 00 00 08 79 CC");
}

}  // namespace
}  // namespace servoctl::session
