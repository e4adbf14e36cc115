// A backup as command lines is run on a drive that holds something else, whatever that is.
#include "backup_fixture.hpp"

namespace servoctl::cli {
namespace {

using Lines = std::vector<std::string>;

struct Replay {
  std::string family;
  Lines held;    ///< What brings the drive to be saved into its state, from the factory's.
  Lines before;  ///< … the drive that the lines meet.
};

class BatchReplay : public BackupTest, public testing::WithParamInterface<Replay> {
 protected:
  /// A drive from the factory that was told this.
  void power_on(const Lines& lines) {
    use("sim:" + GetParam().family + "@1", GetParam().family);
    for (const auto& line : lines) ASSERT_EQ(run(line + " --yes"), 0) << line << "\n" << console.err_text;
  }
};

TEST_P(BatchReplay, ReachesWhatWasSavedFromWhateverWasThere) {
  power_on(GetParam().held);
  ASSERT_EQ(run("backup %saved.txt"), 0) << console.err_text;
  const auto text = slurp("saved.txt");
  for (const auto& before : {Lines{}, GetParam().held, GetParam().before}) {
    power_on(before);
    EXPECT_EQ(run("run %saved.txt"), 0) << console.out_text << console.err_text << text;
    EXPECT_EQ(run("verify %saved.txt"), 0) << console.out_text << console.err_text;
  }
}

TEST_P(BatchReplay, IsRestoredAsABackupWithItsLastValues) {
  power_on(GetParam().held);
  ASSERT_EQ(run("backup %saved.txt"), 0) << console.err_text;
  power_on({});
  EXPECT_EQ(run("restore %saved.txt --yes"), 0) << console.out_text << console.err_text;
  EXPECT_EQ(run("verify %saved.txt"), 0) << console.out_text << console.err_text;
}

/// Heartbeats of nodes 5 and 6 are watched, and the emergencies of this CAN-ID are sent.
Lines watching(const std::string& first, const std::string& second, const std::string& emcy) {
  return {"write 0x1016:1 " + first, "write 0x1016:2 " + second, "write 0x1014 0x80000081",
          "write 0x1014 " + emcy};
}

Lines together(Lines lines, const Lines& more) {
  lines.insert(lines.end(), more.begin(), more.end());
  return lines;
}

constexpr const char* kFive = "0x000501F4";
constexpr const char* kSix = "0x000601F4";

INSTANTIATE_TEST_SUITE_P(
    Families, BatchReplay,
    testing::Values(
        Replay{"gsd600", together(watching(kFive, kSix, "0x1F1"), {"pdo map TPDO1 0x6041 0x6064 --type 1"}),
               together(watching(kSix, kFive, "0x1F2"),
                        {"pdo map TPDO1 0x606C --type 254", "pdo enable TPDO2", "nmt start"})},
        Replay{"gsd600", {"write 0x1016:3 0x000501F4"}, {"write 0x1016:4 0x000501F4"}},
        Replay{"dm",
               together(watching(kFive, kSix, "0x1F1"),
                        {"write 0x1019 10", "write 0x1006 1000", "write 0x1012 0x80000200",
                         "pdo map TPDO1 0x6041 --type 1", "pdo enable TPDO1"}),
               together(watching(kSix, kFive, "0x1F2"),
                        {"write 0x1019 20", "write 0x1006 2000", "write 0x1012 0x80000300",
                         "pdo map TPDO1 0x6064 0x6041 --type 254 --cob-id 0x1A1", "pdo enable TPDO1",
                         "nmt start"})},
        Replay{"da200",
               {"write 0x1006 1000", "pdo map TPDO1 0x6041 --type 1", "pdo disable TPDO2"},
               {"write 0x1006 2000", "pdo map TPDO1 0x6064 0x6041 --type 253", "nmt start"}},
        Replay{"ts",
               {"write 0x1016:1 0x000501F4", "write 0x1014 0x80000081", "write 0x1014 0x1F1",
                "pdo map TPDO1 0x6041 --type 1 --cob-id 0x1A1"},
               {"write 0x1016:1 0x000601F4", "write 0x1014 0x80000081", "write 0x1014 0x1F2",
                "pdo map TPDO1 0x6064 0x6041 --type 255 --cob-id 0x1B1", "nmt start"}},
        Replay{"sv2", {"write 0x1C12:0 0"}, {}}, Replay{"sv2", {}, {"write 0x1C12:0 0"}},
        Replay{"cia402",
               together(watching(kFive, kSix, "0x1F1"),
                        {"write 0x1019 10", "write 0x1006 1000", "write 0x1800:1 0x80000181",
                         "write 0x1800:2 253", "write 0x1800:1 0x00000181", "pdo map TPDO2 0x6041 --type 1"}),
               together(watching(kSix, kFive, "0x1F2"),
                        {"write 0x1019 20", "write 0x1006 2000", "write 0x1800:1 0xC0000181",
                         "write 0x1800:2 1", "write 0x1800:1 0x400001A1",
                         "pdo map TPDO2 0x6064 0x6041 --type 254 --cob-id 0x181", "nmt start"})}),
    [](const auto& test) { return test.param.family + std::to_string(test.index); });

}  // namespace
}  // namespace servoctl::cli
