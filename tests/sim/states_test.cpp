// The step tables of the manual: controlword in, statusword out (tests/vectors/gsd600-states.csv).
#include <cstdio>
#include <map>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/number.hpp"
#include "sim_support.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

/// The statusword the manual prints in this line.
unsigned printed(unsigned line) {
  static const std::map<unsigned, unsigned> kWords = [] {
    std::map<unsigned, unsigned> out;
    const std::string path = source_dir() + "/tests/vectors/gsd600-states.csv";
    const auto table = parse_csv(read_file(path).value(), path).value();
    for (const auto& row : table.rows) {
      const auto number = [&](const char* column) {
        return static_cast<unsigned>(parse_integer(row.cells[table.column(column)]).value().magnitude);
      };
      out.emplace(number("line"), number("statusword"));
    }
    return out;
  }();
  return kWords.at(line);
}

class Transitions : public CellTest {
 protected:
  void SetUp() override {
    build("gsd600@1");
    (void)next();
  }
  void control(unsigned word) {
    char frame[32];
    std::snprintf(frame, sizeof frame, "601#2B406000%02X%02X0000", word & 0xFFU, word >> 8U);
    ASSERT_EQ(ask(frame), "581#6040600000000000");
  }
  void option(unsigned code) {
    char frame[32];
    std::snprintf(frame, sizeof frame, "601#2B5A6000%02X000000", code);
    ASSERT_EQ(ask(frame), "581#605A600000000000");
  }
  void mode(unsigned number) {
    char frame[32];
    std::snprintf(frame, sizeof frame, "601#2F606000%02X000000", number);
    ASSERT_EQ(ask(frame), "581#6060600000000000");
  }
  unsigned status() {
    const auto answer = ask("601#4041600000000000");
    return static_cast<unsigned>(std::stoul(answer.substr(14, 2) + answer.substr(12, 2), nullptr, 16));
  }
};

TEST_F(Transitions, OfTheTableInFiveOneThreeGiveTheStatuswordsItPrints) {
  // Lines 6474 to 6494 of the manual; bits 0 to 9.
  const auto low = [&] { return status() & 0x03FFU; };
  EXPECT_EQ(low(), printed(6478));
  control(0x06);
  EXPECT_EQ(low(), printed(6479));  // 2
  control(0x07);
  EXPECT_EQ(low(), printed(6480));  // 3
  control(0x0F);
  EXPECT_EQ(low(), printed(6481));  // 4
  control(0x07);
  EXPECT_EQ(low(), printed(6482));  // 5
  control(0x06);
  EXPECT_EQ(low(), printed(6483));  // 6
  control(0x00);
  EXPECT_EQ(low(), printed(6484));  // 7
  control(0x06);
  control(0x0F);
  EXPECT_EQ(low(), printed(6481));  // 3 + 4
  control(0x06);
  EXPECT_EQ(low(), printed(6485));  // 8
  control(0x0F);
  control(0x00);
  EXPECT_EQ(low(), printed(6486));  // 9
  control(0x06);
  control(0x07);
  control(0x00);
  EXPECT_EQ(low(), printed(6487));  // 10
}

TEST_F(Transitions, OfAQuickStopEndDisabledOrEnabledBy605A) {
  for (const unsigned code : {0U, 1U, 2U, 3U}) {
    option(code);
    control(0x06);
    control(0x07);
    control(0x0F);
    control(0x02);
    EXPECT_EQ(status() & 0x03FFU, printed(6488)) << code;
    EXPECT_EQ(next(100ms), "");
    EXPECT_EQ(status() & 0x03FFU, printed(6489)) << code;
  }
  for (const unsigned code : {5U, 6U, 7U}) {
    option(code);
    control(0x06);
    control(0x07);
    control(0x0F);
    control(0x02);
    EXPECT_EQ(next(100ms), "");
    EXPECT_EQ(status() & 0x03FFU, printed(6488)) << code;
    control(0x0F);
    EXPECT_EQ(status() & 0x03FFU, printed(6493)) << code;
    control(0x00);
  }
}

TEST_F(Transitions, OfAFaultPassTheReactionAndEndInFault) {
  control(0x06);
  control(0x07);
  control(0x0F);
  drive().raise_fault(0xFF00, {}, bus.now());
  send("601#4041600000000000");
  EXPECT_EQ(next().substr(0, 4), "081#");
  EXPECT_EQ(next(), "581#4B4160003F020000");
  EXPECT_EQ(printed(6490), 0x023FU);
  EXPECT_EQ(next(100ms), "");
  EXPECT_EQ(status() & 0x03FFU, printed(6491));
}

TEST_F(Transitions, InEachModeGiveTheWholeStatuswordsOfTheExamplesBeforeAnythingMoves) {
  struct Row {
    unsigned mode;
    std::vector<unsigned> lines;
  };
  for (const auto& row : {Row{1, {6749, 6750, 6751}}, Row{3, {6934, 6935}}, Row{6, {7384, 7385, 7386}}}) {
    mode(row.mode);
    const unsigned controls[] = {0x06, 0x07, row.mode == 1 ? 0x2FU : 0x0FU};
    for (std::size_t i = 0; i < row.lines.size(); ++i) {
      control(controls[i]);
      EXPECT_EQ(status(), printed(row.lines[i])) << "mode " << row.mode << " step " << i + 1;
    }
    control(0x00);
  }
}

}  // namespace
}  // namespace servoctl::sim
