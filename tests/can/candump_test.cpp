// What candump of can-utils shows on a terminal: files that it wrote itself (tests/cli/data/candump-*.log).
#include "can/candump.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "tests/source_dir.hpp"

namespace servoctl::can {
namespace {

std::vector<std::string> lines_of(const std::string& name) {
  std::ifstream file(std::filesystem::path(source_dir()) / "tests/cli/data" / name);
  std::vector<std::string> out;
  for (std::string line; std::getline(file, line);) out.push_back(line);
  EXPECT_EQ(out.size(), 6U) << name;
  return out;
}

/// What was sent with cansend; the sixth was `123##1AABB`, a CAN FD frame.
constexpr const char* kSent[] = {"601#4000100000000000", "00000181#3702", "701#R", "000#0101", "1F334455#"};

TEST(Candump, IsReadInAllItsFormsOnATerminal) {
  for (const std::string name :
       {"candump-plain.log", "candump-ta.log", "candump-tz.log", "candump-tA.log", "candump-ta-x-a.log"}) {
    SCOPED_TRACE(name);
    const auto lines = lines_of(name);
    Duration before{-1};
    for (std::size_t i = 0; i < std::size(kSent); ++i) {
      const auto read = parse_candump_line(lines[i]);
      ASSERT_TRUE(read) << lines[i];
      EXPECT_EQ(to_string(read->frame), kSent[i]);
      EXPECT_EQ(read->interface_name, "vcan0");
      if (name != "candump-plain.log") {
        EXPECT_GT(read->time, before);
      }
      before = read->time;
    }
    EXPECT_FALSE(parse_candump_line(lines[5])) << "CAN FD";
    EXPECT_TRUE(is_candump_fd(lines[5]));
    EXPECT_FALSE(is_candump_fd(lines[0]));
  }
}

TEST(Candump, HasTheTimesThatItTells) {
  EXPECT_EQ(parse_candump_line(lines_of("candump-plain.log")[0])->time, Duration::zero());
  EXPECT_EQ(parse_candump_line(lines_of("candump-ta.log")[0])->time,
            std::chrono::microseconds(1795318420692527));
  // `date -u -d '2026-11-22 03:33:42' +%s` is 1795318422.
  EXPECT_EQ(parse_candump_line(lines_of("candump-tA.log")[0])->time,
            std::chrono::microseconds(1795318422911092));
}

TEST(Candump, ReadsReportsOfTheController) {
  const auto read = parse_candump_line("  can0  20000004   [8]  00 04 00 00 00 00 60 00   ERRORFRAME");
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->frame.error);
  EXPECT_FALSE(read->frame.extended);
  EXPECT_EQ(read->frame.id, 4U);
}

TEST(Candump, RefusesWhatIsNone) {
  for (const auto* line :
       {"", "can0", "can0 601", "can0 601 [8]", "can0 601 [2] 01", "can0 601 [1] 01 02", "can0 601 [9] 01",
        "can0 6011 [0]", "can0 8FF [0]", "can0 601 [1] 1", "can0 601 [1] GG", "(1.2 can0 601 [0]",
        "(x) can0 601 [0]", "(2026-13-01 00:00:00.0) can0 601 [0]", "(1) can0 601 [0]", "can0 F0000000 [0]"})
    EXPECT_FALSE(parse_candump_line(line)) << line;
}

}  // namespace
}  // namespace servoctl::can
