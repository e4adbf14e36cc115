#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>

#include "session/modbus_network.hpp"
#include "session/session.hpp"
#include "tests/session/modbus_line.hpp"

namespace servoctl::session {
namespace {

using std::chrono::milliseconds;

constexpr ObjectAddress kLateSpeed{0x2033, 0};
constexpr ObjectAddress kLateTorque{0x2095, 0};

/// A unit that does at once what it is asked, and answers as late and as often as a test wants; answers do
/// not overtake each other.
struct SlowUnit {
  struct Write {
    TimePoint time;
    std::uint16_t value;
  };

  ModbusScript script;
  std::map<std::uint16_t, std::vector<Write>> registers;
  std::function<std::pair<Duration, int>()> next = [] { return std::pair{Duration(milliseconds(5)), 1}; };
  TimePoint last{};
  std::unique_ptr<Session> session;

  explicit SlowUnit(std::uint32_t retries) {
    script.answer = [this](const Bytes& request) { return answer(request); };
    Options options;
    options.timeout = milliseconds(100);
    options.retries = retries;
    session = std::make_unique<Session>(
        std::make_unique<ModbusNetwork>(std::make_unique<ScriptedLine>(script), "modbus:/dev/x"),
        "modbus:/dev/x", options);
    drive::ModbusRules rules;
    rules.registers = {{0x2000, 0x300, 0}};
    session->modbus()->learn(1, rules);
    set(0x33, 1);
    set(0x95, 149);
  }

  void set(std::uint16_t at, std::uint16_t value) { registers[at].push_back({script.now, value}); }
  std::uint16_t get(std::uint16_t at) const {
    const auto found = registers.find(at);
    return found == registers.end() ? std::uint16_t{0} : found->second.back().value;
  }
  bool had(std::uint16_t at, std::uint16_t value, TimePoint from) {
    const auto& all = registers[at];
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].value == value && (i + 1 == all.size() || all[i + 1].time >= from)) return true;
    return false;
  }

  std::vector<std::pair<Duration, Bytes>> answer(const Bytes& request) {
    const auto at = modbus::load_be16(ByteSpan(request).subspan(2));
    const auto number = modbus::load_be16(ByteSpan(request).subspan(4));
    Bytes pdu(request.begin() + 1, request.begin() + 6);
    if (request[1] == 0x06) {
      set(at, number);
    } else {
      pdu = {0x03, static_cast<std::uint8_t>(2 * number)};
      for (std::uint16_t i = 0; i < number; ++i)
        modbus::append_be16(pdu, get(static_cast<std::uint16_t>(at + i)));
    }
    const auto [delay, copies] = next();
    last = std::max(last, script.now + delay);
    return {static_cast<std::size_t>(copies),
            {last - script.now, modbus::frame(modbus::Framing::rtu, {1, 0, pdu})}};
  }
};

/// However late: the time-out was 100 ms, and as long again was waited.
TEST(ModbusLate, AnAnswerThatIsLaterThanTheSecondWaitIsNotTheValueOfTheNextRegister) {
  SlowUnit unit(0);
  unit.next = [&] { return std::pair{Duration(milliseconds(unit.script.sent.size() == 1 ? 215 : 5)), 1}; };
  EXPECT_EQ(unit.session->upload(1, kLateSpeed).error().code, Errc::timeout);
  EXPECT_EQ(unit.session->upload(1, kLateTorque), (Bytes{149, 0}));
  EXPECT_EQ(unit.script.sent.size(), 3U) << "a read of two registers stands between them";
}

TEST(ModbusLate, ALateAnswerIsOneToAFurtherTryOfItsRead) {
  SlowUnit unit(1);
  unit.next = [] { return std::pair{Duration(milliseconds(170)), 1}; };
  EXPECT_EQ(unit.session->upload(1, kLateSpeed), (Bytes{1, 0}));
  EXPECT_EQ(unit.script.sent.size(), 1U) << "it came before it was asked again";
}

TEST(ModbusLate, ALateAnswerIsPartOfTheMessageAboutSilence) {
  SlowUnit unit(0);
  unit.next = [] { return std::pair{Duration(milliseconds(170)), 1}; };
  EXPECT_FALSE(unit.session->upload(1, kLateSpeed));
  const auto end = unit.session->upload(1, kLateTorque);
  ASSERT_FALSE(end);
  EXPECT_NE(end.error().message.text().find("; it answered an earlier request after 0.2 s"),
            std::string::npos)
      << end.error().message.text();
  EXPECT_NE(end.error().hint.text().find("--timeout"), std::string::npos) << end.error().hint.text();
}

TEST(ModbusLate, ALineThatIsNeverSilentIsNotWaitedForWithoutEnd) {
  SlowUnit unit(0);
  for (int i = 0; i < 4000; ++i)
    unit.script.coming.emplace_back(unit.script.now + Duration(1000) * i, Bytes{0x55});
  EXPECT_FALSE(unit.session->upload(1, kLateSpeed));
}

RC_GTEST_PROP(Modbus, NoMixtureOfLateAndDoubledAnswersTellsAnUntruth, ()) {
  SlowUnit unit(*rc::gen::inRange<std::uint32_t>(0, 2));
  unit.next = [] {
    return std::pair{
        *rc::gen::weightedElement<Duration>(
            {{6, milliseconds(5)}, {2, milliseconds(170)}, {2, milliseconds(230)}, {1, milliseconds(900)}}),
        *rc::gen::weightedElement<int>({{7, 1}, {2, 2}, {1, 0}})};
  };
  for (int step = *rc::gen::inRange(2, 12); step > 0; --step) {
    const auto object = *rc::gen::element(kLateSpeed, kLateTorque);
    const auto at = static_cast<std::uint16_t>(object.index - 0x2000);
    const auto value = *rc::gen::arbitrary<std::uint8_t>();
    if (*rc::gen::inRange(0, 4) == 0) unit.set(at, value);
    const auto begun = unit.script.now;
    if (*rc::gen::arbitrary<bool>()) {
      const auto end = unit.session->upload(1, object);
      if (end) RC_ASSERT(unit.had(at, static_cast<std::uint16_t>(load_le(*end)), begun));
      continue;
    }
    const auto end = unit.session->download(1, object, {value, 0});
    const auto& all = unit.registers[at];
    if (end)
      RC_ASSERT(std::any_of(all.begin(), all.end(), [&](const auto& write) { return write.value == value; }));
    else
      RC_ASSERT(end.error().code == Errc::timeout || end.error().code == Errc::protocol);
  }
}

}  // namespace
}  // namespace servoctl::session
