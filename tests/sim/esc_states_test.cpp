// The state machine of a simulated slave: every step, what it needs and what it says otherwise (ETG.1000.6,
// clause 6.4.1 and table 11).
#include "esc_support.hpp"

namespace servoctl::sim {
namespace {

using std::chrono::milliseconds;

class EscStatesTest : public EscTest {
 protected:
  void SetUp() override { build(1); }
  /// 1702h and 1B04h: 19 and 29 bytes.
  void assign() {
    for (const auto* request : {"2F 121C 00 00000000", "2B 121C 01 0217 0000", "2F 121C 00 01000000",
                                "2F 131C 00 00000000", "2B 131C 01 041B 0000", "2F 131C 00 01000000"})
      EXPECT_EQ(sdo(request).substr(6, 2), "60") << request;
  }
  void set_up_process_data() {
    EXPECT_EQ(write(0x0810, "0018 1300 64 00 01 00"), 1);
    EXPECT_EQ(write(0x0818, "001C 1D00 20 00 01 00"), 1);
  }
  void go_to_safe_op() {
    go_to_pre_op();
    assign();
    set_up_process_data();
    ASSERT_EQ(request(4), kSafeOp);
  }
  void go_to_op() {
    go_to_safe_op();
    EXPECT_EQ(write(0x1800, Bytes(19, 0)), 1);
    ASSERT_EQ(request(8), kOp);
  }

  const std::string kInit = "01 00 00 00 00 00";
  const std::string kPreOp = "02 00 00 00 00 00";
  const std::string kSafeOp = "04 00 00 00 00 00";
  const std::string kOp = "08 00 00 00 00 00";
};

TEST_F(EscStatesTest, GoesUpStepByStepAndDownAtOnce) {
  EXPECT_EQ(al(), kInit);
  go_to_op();
  for (const auto* way : {"4 2 1", "2 1", "1", "8 4 4 2 2 1 1"}) {
    SCOPED_TRACE(way);
    for (const char* state = way; *state != 0; ++state)
      if (*state != ' ') {
        const auto wanted = static_cast<unsigned>(*state - '0');
        EXPECT_EQ(request(wanted), to_hex(store_le(wanted, 6)));
      }
    for (unsigned manager = 0; manager < 4; ++manager)
      EXPECT_EQ(write(static_cast<std::uint16_t>(0x0806 + 8 * manager), "00"), 1);
    counter_ = 0;
    go_to_op();
  }
}

TEST_F(EscStatesTest, AStepThatDoesNotExistIsRefused) {
  EXPECT_EQ(request(4), "11 00 00 00 11 00");
  EXPECT_EQ(request(0x18), "11 00 00 00 11 00");
  EXPECT_EQ(request(0x13), "11 00 00 00 13 00");  // There is no boot loader.
  EXPECT_EQ(request(0x15), "11 00 00 00 12 00");
  EXPECT_EQ(request(0x10), "11 00 00 00 12 00");
  EXPECT_EQ(request(0x11), kInit);
  go_to_pre_op();
  EXPECT_EQ(request(8), "12 00 00 00 11 00");
  EXPECT_EQ(request(0x13), "12 00 00 00 11 00");
}

TEST_F(EscStatesTest, AnErrorStandsUntilItIsAcknowledged) {
  EXPECT_EQ(request(2), "11 00 00 00 16 00");
  set_up_mailboxes();
  EXPECT_EQ(request(2), "11 00 00 00 16 00");  // Not heard.
  EXPECT_EQ(request(0x11), kInit);
  EXPECT_EQ(request(2), kPreOp);
  EXPECT_EQ(request(8), "12 00 00 00 11 00");
  EXPECT_EQ(request(0x12), kPreOp);
  EXPECT_EQ(request(8), "12 00 00 00 11 00");
  EXPECT_EQ(request(1), kInit);  // INIT needs no such word.
}

TEST_F(EscStatesTest, PreOpNeedsBothMailboxes) {
  struct Row {
    const char* what;
    const char* out;
    const char* in;
  };
  const Row rows[] = {
      {"out is off", "0010 0001 26 00 00 00", "0014 0001 22 00 01 00"},
      {"in is off", "0010 0001 26 00 01 00", "0014 0001 22 00 00 00"},
      {"out has three buffers", "0010 0001 24 00 01 00", "0014 0001 22 00 01 00"},
      {"out is one to be read", "0010 0001 22 00 01 00", "0014 0001 22 00 01 00"},
      {"in is one to be written", "0010 0001 26 00 01 00", "0014 0001 26 00 01 00"},
      {"out is too short", "0010 2100 26 00 01 00", "0014 0001 22 00 01 00"},
      {"out is too long", "0010 0101 26 00 01 00", "0014 0001 22 00 01 00"},
      {"in is too long", "0010 0001 26 00 01 00", "0014 0101 22 00 01 00"},
      {"they overlap", "0010 0001 26 00 01 00", "FF10 0001 22 00 01 00"},
      {"out is among the registers", "000F 0001 26 00 01 00", "0014 0001 22 00 01 00"},
      {"in is behind the memory", "0010 0001 26 00 01 00", "012F 0001 22 00 01 00"},
  };
  for (const auto& row : rows) {
    EXPECT_EQ(write(0x0800, Bytes(16, 0)), 1);
    write(0x0800, row.out);
    write(0x0808, row.in);
    EXPECT_EQ(request(0x12), "11 00 00 00 16 00") << row.what;
  }
  EXPECT_EQ(write(0x0800, Bytes(16, 0)), 1);
  EXPECT_EQ(write(0x0800, "0010 2200 26 00 01 00"), 1);
  EXPECT_EQ(write(0x0808, "2210 2200 22 00 01 00"), 1);  // The least that there is, side by side.
  EXPECT_EQ(request(0x12), kPreOp);
}

TEST_F(EscStatesTest, SafeOpNeedsProcessDataAsTheMappingSays) {
  go_to_pre_op();
  assign();
  struct Row {
    const char* what;
    const char* outputs;
    const char* inputs;
    const char* code;
  };
  const Row rows[] = {
      {"no outputs", "0018 1300 64 00 00 00", "001C 1D00 20 00 01 00", "1D"},
      {"outputs a byte short", "0018 1200 64 00 01 00", "001C 1D00 20 00 01 00", "1D"},
      {"outputs a byte long", "0018 1400 64 00 01 00", "001C 1D00 20 00 01 00", "1D"},
      {"outputs to be read", "0018 1300 60 00 01 00", "001C 1D00 20 00 01 00", "1D"},
      {"outputs as a mailbox", "0018 1300 66 00 01 00", "001C 1D00 20 00 01 00", "1D"},
      {"outputs in the mailbox", "E010 1300 64 00 01 00", "001C 1D00 20 00 01 00", "1D"},
      {"outputs whose third buffer is in the inputs", "D81B 1300 64 00 01 00", "001C 1D00 20 00 01 00", "1E"},
      {"no inputs", "0018 1300 64 00 01 00", "001C 1D00 20 00 00 00", "1E"},
      {"inputs a byte short", "0018 1300 64 00 01 00", "001C 1C00 20 00 01 00", "1E"},
      {"inputs to be written", "0018 1300 64 00 01 00", "001C 1D00 24 00 01 00", "1E"},
  };
  for (const auto& row : rows) {
    EXPECT_EQ(write(0x0810, Bytes(16, 0)), 1);
    write(0x0810, row.outputs);
    write(0x0818, row.inputs);
    EXPECT_EQ(request(0x14), std::string("12 00 00 00 ") + row.code + " 00") << row.what;
  }
  EXPECT_EQ(write(0x0810, Bytes(16, 0)), 1);
  set_up_process_data();
  EXPECT_EQ(write(0x0820, "001F 0100 20 00 01 00"), 1);
  EXPECT_EQ(request(0x14), "12 00 00 00 17 00");
  EXPECT_EQ(write(0x0826, "00"), 1);
  EXPECT_EQ(request(0x14), kSafeOp);
}

TEST_F(EscStatesTest, WithoutAssignedPdosThereMustBeNoProcessData) {
  go_to_pre_op();
  set_up_process_data();
  EXPECT_EQ(request(4), "12 00 00 00 1D 00");
  EXPECT_EQ(write(0x0816, "00"), 1);
  EXPECT_EQ(request(0x14), "12 00 00 00 1E 00");
  EXPECT_EQ(write(0x081E, "00"), 1);
  EXPECT_EQ(request(0x14), kSafeOp);
  EXPECT_EQ(request(8), kOp);
}

TEST_F(EscStatesTest, SyncManagersThatAreOnKeepTheirSettings) {
  go_to_pre_op();
  EXPECT_EQ(write(0x0800, "0018 0002 22 00 01 00"), 1);  // Its activation is written, and as it was.
  EXPECT_EQ(show(0x0800, 5), "00 10 00 01 26");
  EXPECT_EQ(al(), kPreOp);
}

TEST_F(EscStatesTest, OpWaitsForOutputsAndIsRefusedWithout) {
  go_to_safe_op();
  EXPECT_EQ(request(8), kSafeOp);
  run(milliseconds(199));
  EXPECT_EQ(al(), kSafeOp);
  EXPECT_EQ(write(0x1800, Bytes(19, 0)), 1);
  EXPECT_EQ(al(), kOp);
  EXPECT_EQ(request(4), kSafeOp);
  run(milliseconds(150));  // The watchdog ends: the outputs are old.
  EXPECT_EQ(request(8), kSafeOp);
  run(milliseconds(200));
  EXPECT_EQ(al(), "14 00 00 00 1B 00");
}

TEST_F(EscStatesTest, ASyncManagerThatIsSwitchedOffEndsTheStateThatNeedsIt) {
  go_to_op();
  EXPECT_EQ(write(0x0816, "00"), 1);
  EXPECT_EQ(al(), "12 00 00 00 1D 00");
  EXPECT_EQ(write(0x0816, "01"), 1);
  EXPECT_EQ(request(0x14), kSafeOp);
  EXPECT_EQ(write(0x081E, "00"), 1);
  EXPECT_EQ(al(), "12 00 00 00 1E 00");
  EXPECT_EQ(write(0x0806, "00"), 1);
  EXPECT_EQ(al(), "11 00 00 00 16 00");
}

TEST_F(EscStatesTest, FallsOutOfOpByItself) {
  go_to_op();
  slave().plan_fall({now_ + milliseconds(10), EscState::safe_op, 0x001A});
  EXPECT_EQ(write(0x1800, Bytes(19, 0)), 1);
  run(milliseconds(9));
  EXPECT_EQ(al(), kOp);
  run(milliseconds(1));
  EXPECT_EQ(al(), "14 00 00 00 1A 00");
  EXPECT_EQ(write(0x1800, Bytes(19, 0)), 1);
  EXPECT_EQ(request(0x18), kOp);
}

TEST_F(EscStatesTest, DoesNotFallUpwards) {
  go_to_pre_op();
  slave().plan_fall({now_ + milliseconds(10), EscState::safe_op, 0x001A});
  run(milliseconds(20));
  EXPECT_EQ(al(), kPreOp);
}

TEST_F(EscStatesTest, OutputsOfAnEarlierTimeDoNotCount) {
  go_to_op();
  EXPECT_EQ(request(2), kPreOp);
  EXPECT_EQ(request(4), kSafeOp);
  EXPECT_EQ(request(8), kSafeOp);
  EXPECT_EQ(write(0x1800, Bytes(19, 0)), 1);
  EXPECT_EQ(al(), kOp);
}

TEST_F(EscStatesTest, OneThatRefusesFreeRunWantsSync0) {
  slave().faults().refuses_free_run = true;
  go_to_safe_op();
  EXPECT_EQ(write(0x1800, Bytes(19, 0)), 1);
  EXPECT_EQ(request(8), "14 00 00 00 27 00");
  EXPECT_EQ(write(0x0990, store_le(1, 8)), 1);  // The first pulse was to come long ago.
  EXPECT_EQ(write(0x09A0, store_le(4'000'000, 4)), 1);
  EXPECT_EQ(write(0x0980, "00 03"), 1);
  EXPECT_EQ(request(0x18), "14 00 00 00 2D 00");
  EXPECT_EQ(write(0x0981, "00"), 1);
  EXPECT_EQ(write(0x0990, store_le(2'000'000'000, 8)), 1);
  EXPECT_EQ(write(0x0981, "01"), 1);  // Cyclic, and no pulse.
  EXPECT_EQ(request(0x18), "14 00 00 00 27 00");
  EXPECT_EQ(write(0x09A0, store_le(0, 4)), 1);
  EXPECT_EQ(write(0x0981, "03"), 1);  // A pulse, and no cycle.
  EXPECT_EQ(request(0x18), "14 00 00 00 27 00");
  EXPECT_EQ(write(0x09A0, store_le(4'000'000, 4)), 1);
  EXPECT_EQ(write(0x0981, "03"), 1);
  EXPECT_EQ(request(0x18), kOp);
}

TEST_F(EscStatesTest, AStateComesLate) {
  slave().faults().state_delay = milliseconds(50);
  set_up_mailboxes();
  EXPECT_EQ(request(2), kInit);
  run(milliseconds(49));
  EXPECT_EQ(al(), kInit);
  run(milliseconds(1));
  EXPECT_EQ(al(), kPreOp);
}

TEST_F(EscStatesTest, APowerCycleForgetsStateAddressAndSettings) {
  go_to_op();
  ring_.power_off(0);
  EXPECT_EQ(read(0x0130, 2).counter, -1);
  run(milliseconds(500));
  ring_.power_on(0, now_);
  EXPECT_EQ(read(0x0130, 2).counter, 0);
  const auto got = datagram(kAprd, 0x0010'0000, Bytes(2, 0));
  EXPECT_EQ(to_hex(got.data), "00 00");
  EXPECT_EQ(datagram(kApwr, 0x0010'0000, store_le(kStation, 2)).counter, 1);
  EXPECT_EQ(al(), kInit);
  EXPECT_EQ(show(0x0800, 8), "00 00 00 00 00 30 00 00");
}

}  // namespace
}  // namespace servoctl::sim
