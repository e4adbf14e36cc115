#include "ethercat/al_request.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "ethercat/registers.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

/// 0120h and 0130h of a slave.
struct AlSlave {
  AlStatus status{AlState::preop, false, 0};
  Duration takes = 5ms;       ///< For a step.
  std::uint16_t refuses = 0;  ///< With this code.
  bool stays = false;
  bool keeps_error = false;
  int lost = 0;
  bool gone = false;
  std::vector<std::uint16_t> written;
  std::optional<AlState> wanted;
  TimePoint ready;
  Bytes reply;

  Answer answer(const Request& request, TimePoint now) {
    if (lost > 0) {
      --lost;
      return {{}, 0, true, now};
    }
    if (gone) return {{}, 0, false, now};
    EXPECT_EQ(request.address & 0xFFFFU, 0x1002U);
    if (request.command == Command::fpwr) {
      EXPECT_EQ(request.address >> 16U, reg::kAlControl);
      written.push_back(static_cast<std::uint16_t>(load_le(request.data)));
      control(written.back(), now);
      return {{}, 1, false, now};
    }
    EXPECT_EQ(request.address >> 16U, reg::kAlStatus);
    if (wanted && !stays && now >= ready) status = {*std::exchange(wanted, std::nullopt), false, 0};
    reply = store_le(static_cast<std::uint64_t>(status.state) | (status.error ? 0x10U : 0U), 6);
    store_le(status.code, std::span(reply).subspan(4, 2));
    return {reply, 1, false, now};
  }
  void control(std::uint16_t value, TimePoint now) {
    if ((value & reg::kAlAcknowledge) != 0) status.error = keeps_error && status.error;
    if ((value & reg::kAlAcknowledge) != 0) return;
    if (status.error) return;
    if (refuses != 0) {
      status.error = true;
      status.code = refuses;
      return;
    }
    wanted = static_cast<AlState>(value);
    ready = now + takes;
  }
};

class AlRequestTest : public testing::Test {
 protected:
  Result<AlStatus> ask(AlState target, std::optional<Duration> timeout = {}) {
    request.start(target, now, timeout);
    return run();
  }
  Result<AlStatus> run() {
    for (int steps = 0; steps < 100'000; ++steps) {
      if (auto result = request.take_result()) {
        EXPECT_EQ(request.deadline(), kNever);
        EXPECT_FALSE(request.take_request());
        EXPECT_FALSE(request.busy());
        return *result;
      }
      if (const auto asked = request.take_request()) {
        now += 50us;
        request.on_answer(slave.answer(*asked, now), now);
        continue;
      }
      EXPECT_NE(request.deadline(), kNever);
      now = std::max(now, request.deadline());
      request.on_time(now);
    }
    return fail(Errc::bug, "no end");
  }
  using Written = std::vector<std::uint16_t>;

  AlSlave slave;
  AlRequest request{2, SlaveAddress::station(0x1002)};
  TimePoint now{1s};
};

TEST_F(AlRequestTest, AStateIsAskedForAndWaitedFor) {
  const auto status = ask(AlState::safeop);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, AlState::safeop);
  EXPECT_EQ(slave.written, Written{4});
  EXPECT_GE(now, TimePoint{1s} + 5ms);
  EXPECT_LT(now, TimePoint{1s} + 8ms);
  EXPECT_FALSE(request.found());
}

TEST_F(AlRequestTest, ASlaveThatIsThereAlreadyIsAskedForNothing) {
  EXPECT_TRUE(ask(AlState::preop));
  EXPECT_EQ(slave.written, Written{});
}

TEST_F(AlRequestTest, AnErrorThatStandsIsAcknowledgedFirstAndKept) {
  slave.status = {AlState::safeop, true, 0x001B};
  EXPECT_EQ(ask(AlState::preop)->state, AlState::preop);
  EXPECT_EQ(slave.written, (Written{0x14, 0x02}));
  EXPECT_EQ(request.found(), (AlStatus{AlState::safeop, true, 0x001B}));
}

TEST_F(AlRequestTest, AnErrorInTheStateThatIsWantedIsAcknowledgedAndThatIsAll) {
  slave.status = {AlState::preop, true, 0x001E};
  EXPECT_TRUE(ask(AlState::preop));
  EXPECT_EQ(slave.written, Written{0x12});
}

TEST_F(AlRequestTest, ARefusalIsToldInWordsWithWhatToDo) {
  slave.refuses = 0x001D;
  const auto status = ask(AlState::safeop);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Errc::negative);
  EXPECT_EQ(status.error().message.text(),
            "node 2: SAFE-OP refused, state is PRE-OP: invalid output settings (AL status code 001Dh)");
  EXPECT_NE(status.error().hint.text().find("`pdo show`"), std::string::npos);
  EXPECT_EQ(status.error().node, 2);
}

TEST_F(AlRequestTest, AnErrorThatStaysAfterItsAcknowledgeIsARefusal) {
  slave.status = {AlState::init, true, 0x0014};
  slave.keeps_error = true;
  const auto status = ask(AlState::preop);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message.text(),
            "node 2: PRE-OP refused, state is INIT: no valid firmware (AL status code 0014h)");
  EXPECT_GE(now, TimePoint{1s} + 500ms);
  EXPECT_EQ(slave.written, Written{0x11});
}

TEST_F(AlRequestTest, ASlaveThatStaysWhereItIsEndsTheWait) {
  slave.stays = true;
  slave.status.state = AlState::safeop;
  const auto status = ask(AlState::op, 300ms);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Errc::timeout);
  EXPECT_EQ(status.error().message.text(), "node 2: OP was requested, state is still SAFE-OP");
  EXPECT_GE(now, TimePoint{1s} + 300ms);
  EXPECT_LT(now, TimePoint{1s} + 310ms);
}

TEST_F(AlRequestTest, LostFramesAreAskedAgain) {
  slave.lost = 20;
  EXPECT_TRUE(ask(AlState::safeop));
  slave.lost = 1'000'000;
  const auto status = ask(AlState::op);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message.text(), "node 2: frames do not come back");
  EXPECT_EQ(status.error().code, Errc::timeout);
}

TEST_F(AlRequestTest, ASlaveThatIsGoneIsTold) {
  slave.gone = true;
  const auto status = ask(AlState::op);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message.text(), "node 2: it does not answer");
}

TEST_F(AlRequestTest, ALookChangesNothing) {
  slave.status = {AlState::safeop, true, 0x001B};
  request.start_look(now);
  EXPECT_EQ(run().value(), (AlStatus{AlState::safeop, true, 0x001B}));
  EXPECT_EQ(slave.written, Written{});
}

TEST(AlStatus, StatesAreWalkedUpOneByOneAndDownAtOnce) {
  using S = AlState;
  EXPECT_EQ(next_al_state(S::init, S::op), S::preop);
  EXPECT_EQ(next_al_state(S::preop, S::op), S::safeop);
  EXPECT_EQ(next_al_state(S::safeop, S::op), S::op);
  EXPECT_EQ(next_al_state(S::op, S::safeop), S::safeop);
  EXPECT_EQ(next_al_state(S::op, S::preop), S::preop);
  EXPECT_EQ(next_al_state(S::op, S::init), S::init);
  EXPECT_EQ(next_al_state(S::safeop, S::preop), S::preop);
  EXPECT_EQ(next_al_state(S::preop, S::preop), S::preop);
  EXPECT_EQ(next_al_state(S::op, S::boot), S::init);
  EXPECT_EQ(next_al_state(S::init, S::boot), S::boot);
  EXPECT_EQ(next_al_state(S::boot, S::op), S::init);
}

TEST(AlStatus, RegistersAreTakenApart) {
  EXPECT_EQ(parse_al_status(hex("1400 0000 1B00")), (AlStatus{AlState::safeop, true, 0x001B}));
  EXPECT_EQ(parse_al_status(hex("2800 0000 0000")), (AlStatus{AlState::op, false, 0}));
  EXPECT_EQ(parse_al_status(hex("0800")), AlStatus{});
}

TEST(AlStatus, EachCodeThatAnEngineerMeetsSaysWhatToDo) {
  for (const int code :
       {0x0011, 0x0014, 0x0015, 0x0016, 0x0017, 0x0018, 0x0019, 0x001A, 0x001B, 0x001C, 0x001D,
        0x001E, 0x001F, 0x0020, 0x0021, 0x0022, 0x0023, 0x0024, 0x0025, 0x0026, 0x0027, 0x0028,
        0x0029, 0x002B, 0x002C, 0x002D, 0x0030, 0x0032, 0x0034, 0x0035, 0x0036, 0x0051, 0x0060}) {
    const auto number = static_cast<std::uint16_t>(code);
    EXPECT_EQ(al_status_text(number).find("not list"), std::string::npos) << code;
    EXPECT_NE(al_status_hint(number), "") << code;
  }
  EXPECT_EQ(al_status_text(0x8001), "vendor-specific code");
  EXPECT_EQ(al_status_text(0x7FFF), "code not listed in ETG.1000.6");
  EXPECT_NE(al_status_hint(0x8001), "");
  EXPECT_EQ(al_status_text(0x0027), "free run is not supported");
  EXPECT_EQ(name(AlState::safeop), "SAFE-OP");
  EXPECT_EQ(name(static_cast<AlState>(7)), "unknown state");
}

}  // namespace
}  // namespace servoctl::ethercat
