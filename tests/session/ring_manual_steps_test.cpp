// The sequences that the manual prints for each mode (tests/vectors/sv2-states.csv), over EtherCAT: outputs
// and statusword by process data, the rest by mailbox.
#include "drive/standard_objects.hpp"

#include <ios>
#include "ethercat_world.hpp"
#include "tests/sim/manual_rows.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

class RingManualSteps : public EtherCatTest {
 protected:
  void SetUp() override {
    open("sv2@1");
    network().learn(1, rules());
    ASSERT_TRUE(network().request_state(1, NodeState::operational));
  }
  void write(ObjectAddress object, unsigned value, std::size_t size) {
    const auto done = session_->download(1, object, store_le(value, size));
    ASSERT_TRUE(done) << done.error().message.text();
  }
  unsigned status() {
    const auto word = session_->upload(1, objects::kStatusword);
    return word ? static_cast<unsigned>(load_le(*word)) : 0;
  }
  bool reaches(unsigned statusword, unsigned mask) {
    for (const auto end = session_->now() + 10s; session_->now() < end;) {
      if ((status() & mask) == (statusword & mask)) return true;
      (void)session_->wait([] { return false; }, session_->now() + 4ms);
    }
    return false;
  }
  void begin(unsigned mode) {
    write(objects::kControlword, 0, 2);
    write(objects::kModeOfOperation, mode, 1);
    ASSERT_TRUE(reaches(0x0040, 0x006F));
    for (const auto word : {6U, 7U, 15U}) write(objects::kControlword, word, 2);
    ASSERT_TRUE(reaches(0x0027, 0x006F)) << std::hex << status();
  }
  void expect_row(const sim::ManualRow& row) {
    EXPECT_TRUE(reaches(row.statusword, row.mask))
        << "line " << row.line << ": " << std::hex << status() << " for " << row.statusword;
  }
  /// Every controlword of these lines, and the statusword it leads to.
  void play(const std::string& mode, unsigned number, unsigned first, unsigned last, unsigned step = 0) {
    begin(number);
    const auto rows = sim::manual_rows("sv2", mode, first, last);
    ASSERT_FALSE(rows.empty());
    bool high = false;
    for (const auto& row : rows) {
      if (row.controlword) {
        const bool edge = (*row.controlword & 0x10U) != 0 && !high;
        if (edge && step != 0) write(objects::kTargetPosition, target_ += step, 4);
        high = (*row.controlword & 0x10U) != 0;
        write(objects::kControlword, *row.controlword, 2);
      }
      expect_row(row);
    }
  }
  void expect_line(const std::string& mode, unsigned line, unsigned step = 0) {
    const auto rows = sim::manual_rows("sv2", mode, line, line);
    ASSERT_GT(rows.size(), step);
    expect_row(rows[step]);
  }

  unsigned target_ = 0;
};

TEST_F(RingManualSteps, OfProfilePosition) {
  write({0x6081, 0}, 10'000, 4);
  play("pp", 1, 1063, 1071, 20'000);
  play("pp", 1, 1085, 1089, 20'000);
  expect_line("pp", 1032);
  EXPECT_EQ(load_le(session_->upload(1, objects::kPositionActual).value()), target_);
}

TEST_F(RingManualSteps, OfProfileVelocity) {
  begin(3);
  write(objects::kTargetVelocity, 50'000, 4);
  expect_line("pv", 1116);
  const auto speed = static_cast<double>(load_le(session_->upload(1, objects::kVelocityActual).value()));
  EXPECT_NEAR(speed, 50'000, 500);
}

TEST_F(RingManualSteps, OfProfileTorque) {
  begin(4);
  write(objects::kTargetTorque, 50, 2);
  expect_line("pt", 1165);
  EXPECT_NEAR(static_cast<double>(load_le(session_->upload(1, objects::kTorqueActual).value())), 50, 5);
}

TEST_F(RingManualSteps, OfHoming) {
  play("hm", 6, 1211, 1215);
  expect_line("hm", 1220, 1);
}

TEST_F(RingManualSteps, OfCyclicPositionAsFarAsACycleOfFourMillisecondsGoes) {
  begin(8);
  expect_line("csp", 965);
  const auto from = static_cast<unsigned>(load_le(session_->upload(1, objects::kPositionActual).value()));
  for (unsigned i = 1; i <= 50; ++i) write(objects::kTargetPosition, from + 40 * i, 4);
  (void)session_->wait([] { return false; }, session_->now() + 500ms);
  EXPECT_NEAR(static_cast<double>(load_le(session_->upload(1, objects::kPositionActual).value())),
              from + 2000.0, 20);
}

/// The manual has a block diagram and the PDOs for csv and cst (977-1012), and no sequence: the bits are
/// those of CiA 402-2.
TEST_F(RingManualSteps, OfCyclicVelocityWhichFollowsItsTargetWithoutARamp) {
  write({0x6083, 0}, 1000, 4);  // A ramp that profile velocity would take ten seconds for.
  begin(9);
  write(objects::kTargetVelocity, 10'000, 4);
  (void)session_->wait([] { return false; }, session_->now() + 20ms);
  const auto speed = [&] {
    return static_cast<double>(
        static_cast<std::int32_t>(load_le(session_->upload(1, objects::kVelocityActual).value())));
  };
  EXPECT_NEAR(speed(), 10'000, 1);
  EXPECT_EQ(status() & 0x1400U, 0x1000U) << "it follows; there is nothing to reach";
  write(objects::kTargetVelocity, 0xFFFF'F000U, 4);
  (void)session_->wait([] { return false; }, session_->now() + 20ms);
  EXPECT_NEAR(speed(), -4096, 1);
  const auto from = static_cast<std::int32_t>(load_le(session_->upload(1, objects::kPositionActual).value()));
  (void)session_->wait([] { return false; }, session_->now() + 1s);
  const auto to = static_cast<std::int32_t>(load_le(session_->upload(1, objects::kPositionActual).value()));
  EXPECT_NEAR(to - from, -4096, 64);
  write(objects::kControlword, 0, 2);
  EXPECT_TRUE(reaches(0x0040, 0x006F));
  (void)session_->wait([] { return false; }, session_->now() + 20ms);
  EXPECT_EQ(speed(), 0) << "without power it stands, whatever 60FFh says";
}

TEST_F(RingManualSteps, OfCyclicTorqueWhichFollowsItsTarget) {
  begin(10);
  write(objects::kTargetTorque, 50, 2);
  (void)session_->wait([] { return false; }, session_->now() + 20ms);
  EXPECT_NEAR(static_cast<double>(load_le(session_->upload(1, objects::kTorqueActual).value())), 50, 5);
  EXPECT_EQ(status() & 0x1400U, 0x1000U);
  write(objects::kTargetTorque, 0, 2);
  (void)session_->wait([] { return false; }, session_->now() + 20ms);
  EXPECT_EQ(load_le(session_->upload(1, objects::kTorqueActual).value()), 0U);
}

}  // namespace
}  // namespace servoctl::session
