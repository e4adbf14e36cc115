// The examples of the TS manual, sent to a simulated TS as they are printed (tests/vectors/ts.txt, with the
// lines of the manual): each is acknowledged with its data (37, 1696), and does what the manual says of it.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "base/file.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "sim_support.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

struct Printed {
  unsigned line = 0;  ///< Its first line in the manual.
  std::string frame;  ///< What the master sends.
};

/// What the master sends in the examples that begin in these lines.
std::vector<Printed> printed_frames(unsigned first, unsigned last) {
  std::vector<Printed> out;
  const auto text = read_file(source_dir() + "/tests/vectors/ts.txt").value();
  unsigned line = 0;
  for (const auto row : split(text, '\n')) {
    if (row.starts_with("# --- Put together")) break;
    if (row.starts_with("@ ")) {
      const auto digits = row.substr(2, row.find_first_not_of("0123456789", 2) - 2);
      line = static_cast<unsigned>(parse_digits(digits, 10).value());
    }
    if (row.starts_with("> ") && line >= first && line <= last)
      out.push_back({line, std::string(row.substr(2))});
  }
  return out;
}

/// Simulated TS drives with the node-IDs of the examples.
class TsDrives : public DrivenTest {
 protected:
  /// They are set up for CANopen (235, 1869) and have begun.
  void start(std::string_view drives) {
    family_ = "ts";
    build(drives);
    commission(cell_);
    for (std::size_t i = 0; i < cell_.drives.size(); ++i) (void)next(100ms);
  }
  std::string answer_of(const std::string& request) {
    send(request);
    auto answer = next();
    while (!answer.empty() && answer.substr(0, 2) != "58") answer = next();
    return answer;
  }
  void replay(unsigned first, unsigned last, std::size_t count) {
    const auto frames = printed_frames(first, last);
    EXPECT_EQ(frames.size(), count);
    for (const auto& printed : frames) {
      if (!printed.frame.starts_with("60")) {
        send(printed.frame);
        continue;
      }
      const auto answer = answer_of(printed.frame);
      EXPECT_EQ(answer, "58" + printed.frame.substr(2, 2) + "60" + printed.frame.substr(6))
          << "line " << printed.line;
    }
  }
  std::int32_t value(unsigned node, std::uint16_t index, unsigned sub = 0) {
    const auto answer = answer_of(
        fmt::format("{:03X}#40{:02X}{:02X}{:02X}00000000", 0x600 + node, index & 0xFFU, index >> 8U, sub));
    const auto data = parse_hex_bytes(answer.substr(12)).value();
    const auto type = profile().dictionary.find({index, static_cast<std::uint8_t>(sub)})->type;
    const auto number = od::decode(type, std::span(data).first(od::size_of(type).value()));
    return static_cast<std::int32_t>(od::to_double(number.value()));
  }
};

class TsManual : public TsDrives {
 protected:
  void SetUp() override { start("ts@1,ts@2"); }
};

TEST(TsManualFrames, AreEachSentByATest) {
  constexpr std::pair<unsigned, unsigned> kSent[] = {{36, 37},     {1615, 1617}, {1700, 1705},
                                                     {1727, 1797}, {1810, 1811}, {1872, 1911},
                                                     {1993, 2049}, {2096, 2111}, {2151, 2179}};
  std::size_t count = 0;
  for (const auto& [first, last] : kSent) count += printed_frames(first, last).size();
  EXPECT_EQ(count, printed_frames(0, 10000).size());
}

TEST_F(TsDrives, ObeyTheNmtFrames) {  // 1615, 1617
  start("ts@6");
  (void)answer_of("606#2B17100064000000");
  const auto printed = printed_frames(1615, 1617);
  ASSERT_EQ(printed.size(), 2U);
  send(printed[0].frame);
  EXPECT_EQ(next(150ms), "706#05");
  send(printed[1].frame);
  EXPECT_EQ(next(150ms), "706#7F");
}

TEST_F(TsManual, ReadsAndWritesOfFnAndDnAreAnsweredAsPrinted) {  // 36, 1701-1705
  replay(36, 37, 1);
  replay(1704, 1705, 1);
  // The motor turns at 100 rpm, as in the printed answer.
  for (const char* request : {"601#2F60600003000000", "601#23FF6000E8030000", "601#2B40600006000000",
                              "601#2B40600007000000", "601#2B4060000F000000"})
    ASSERT_EQ(answer_of(request).substr(0, 6), "581#60") << request;
  wait(2s);
  EXPECT_EQ(answer_of(printed_frames(1700, 1701).at(0).frame), "581#4B00300064000000");
}

TEST_F(TsManual, PdosAreMappedAndSentByTheirTimer) {  // 1727-1797
  replay(1727, 1797, 20);
  for (const auto record : {std::uint16_t{0x1800}, std::uint16_t{0x1801}}) {
    EXPECT_EQ(value(2, record, 5), 0x190);
    EXPECT_EQ(value(2, record, 3), 0x190);
    EXPECT_EQ(value(2, record, 2), 254);
  }
  send("000#0102");
  int first = 0;
  int second = 0;
  for (const auto end = bus.now() + 2100ms; bus.now() < end;) {
    const auto frame = next(end - bus.now());
    if (frame.starts_with("182#")) ++first;
    if (frame.starts_with("282#")) ++second;
  }
  EXPECT_EQ(first, 6) << "at once, then every 400 ms";
  EXPECT_EQ(second, 6);
}

TEST_F(TsManual, HeartbeatIsTurnedOffAndOn) {  // 1810, 1811
  replay(1810, 1811, 2);
  EXPECT_EQ(next(150ms), "701#7F");
  replay(1810, 1810, 1);
  EXPECT_EQ(next(1s), "");
}

TEST_F(TsManual, VelocityExampleTurnsTheMotorWithoutSync) {  // 1872-1911
  replay(1872, 1911, 17);
  wait(1s);
  EXPECT_EQ(value(2, 0x60FF), 100);
  EXPECT_EQ(value(2, 0x6083), 1000);
  EXPECT_EQ(value(2, 0x606B), 100);  // 0.1 rpm (1844, 1927)
  EXPECT_EQ(value(2, 0x6069), 100);  // 0.1 rpm (1929)
  EXPECT_EQ(value(2, 0x606C), 10);   // 1 rpm (1846)
  EXPECT_EQ(value(2, 0x3000), 10);   // Dn_00
}

TEST_F(TsManual, PositionExampleMovesSixtyThousandPulses) {  // 1993-2049
  replay(1993, 2049, 26);
  wait(500ms);
  EXPECT_EQ(value(2, 0x6069), 3000);
  EXPECT_EQ(value(2, 0x606B), 3000);
  EXPECT_EQ(value(2, 0x3000), 300);
  wait(3s);
  EXPECT_EQ(value(2, 0x6064), 60000);
  EXPECT_EQ(value(2, 0x3000), 0);
  EXPECT_EQ(value(2, 0x6093, 1), 1);
  EXPECT_EQ(value(2, 0x6093, 2), 1);
}

TEST_F(TsManual, TorqueExampleIsTakenByTheSizeOfTheObjects) {  // 2096-2111
  replay(2096, 2111, 7);
  EXPECT_EQ(value(2, 0x6087), 1000);
  EXPECT_EQ(value(2, 0x6071), 100);
  EXPECT_EQ(value(2, 0x6060), 3) << "as printed; 4 is meant (2100)";
}

TEST_F(TsManual, HomingExampleFindsTheHomeSwitch) {  // 2151-2179
  replay(2151, 2179, 14);
  wait(20s);
  EXPECT_EQ(static_cast<unsigned>(value(2, 0x6041)) & 0x3400U, 0x1400U);
}

TEST_F(TsManual, OtherObjectsTakeNoShortWrite) {
  EXPECT_EQ(answer_of("602#2F836000E8030000"), "582#8083600010000706");
  EXPECT_EQ(answer_of("602#2B7A600001000000"), "582#807A600010000706");
  EXPECT_EQ(answer_of("602#2371600064000000"), "582#8071600010000706") << "longer than it is";
}

TEST_F(TsDrives, OtherFamiliesTakeNoCountsWhereThePositionIsAnAngle) {
  const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
  EXPECT_FALSE(build_cell("dm@1?counts=5000", folders, bus.now()));
}

TEST_F(TsDrives, HaveTheCountsOfTheOption) {  // No object of the TS gives them.
  start("ts@1,ts@2?counts=5000");
  replay(1872, 1911, 17);
  wait(6s);
  EXPECT_NEAR(value(2, 0x6064), 5000, 50) << "10 rpm for 6 s";
}

}  // namespace
}  // namespace servoctl::sim
