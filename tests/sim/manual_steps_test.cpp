// The sequences the manuals print for each mode: controlword in, statusword reached, one after the other on
// the same drive (tests/vectors/*-states.csv).
#include "manual_rows.hpp"

#include <ios>
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class ManualSteps : public DrivenTest {
 protected:
  /// What stands before the sequence: the steps of CiA 402 it leaves out.
  void prepare(unsigned first_controlword) {
    if ((first_controlword & 0x01U) != 0) write({0x6040, 0}, "6");
    if ((first_controlword & 0x08U) != 0) write({0x6040, 0}, "7");
  }

  void play(const std::string& mode, int number, unsigned first, unsigned last,
            std::string_view target = {}) {
    const auto rows = manual_rows(family_, mode, first, last);
    ASSERT_FALSE(rows.empty());
    write({0x6040, 0}, "0");
    write({0x6060, 0}, std::to_string(number));
    prepare(rows.front().controlword.value_or(0x0F));
    bool high = false;
    for (const auto& row : rows) {
      if (row.controlword) {
        const bool edge = (*row.controlword & 0x10U) != 0 && !high;
        if (edge && !target.empty())
          write({0x607A, 0}, std::to_string(std::stoi(std::string(target)) * ++moves_));
        high = (*row.controlword & 0x10U) != 0;
        write({0x6040, 0}, std::to_string(*row.controlword));
      }
      EXPECT_TRUE(reaches(row.statusword, row.mask))
          << family_ << " line " << row.line << ": " << std::hex << status() << " for " << row.statusword
          << " under " << row.mask;
    }
  }
  int moves_ = 0;
};

TEST_F(ManualSteps, OfTheGsd600AreReachedInTheirOrder) {
  boot("gsd600");
  obey_switches();
  write({0x6081, 0}, "100000");
  write({0x6083, 0}, "1000000");
  write({0x60FF, 0}, "100000");
  play("pv", 3, 6934, 6937);
  play("pp", 1, 6749, 6758, "50000");
  play("pp", 1, 6780, 6785, "50000");
  play("hm", 6, 7384, 7387);
  play("hm", 6, 7400, 7403);
  play("pv", 3, 6950, 6953);
}

TEST_F(ManualSteps, OfTheDmAreReachedInTheirOrder) {
  boot("dm");
  play("pt", 6, 184, 189);
  play("pv", 4, 237, 237);
  play("pp", 1, 298, 298);
}

TEST_F(ManualSteps, OfTheDa200AreReachedInTheirOrder) {
  boot("da200");
  write({0x6081, 0}, "100");
  for (const auto& [first, last] : {std::pair{452U, 455U}, {459U, 462U}, {470U, 473U}, {477U, 480U}})
    play("pp", 1, first, last, "1000");
  play("ip", 7, 504, 530);
  play("hm", 6, 572, 573);
  play("pv", 3, 680, 680);
  play("pt", 4, 731, 731);
}

TEST_F(ManualSteps, OfTheTsAreReachedInTheirOrder) {
  boot("ts");
  play("pv", 3, 1909, 1911);
  play("pp", 1, 2042, 2049, "1000");
  play("pt", 4, 2109, 2111);
  play("hm", 6, 2172, 2179);
}

TEST_F(ManualSteps, OfTheSv2AreReachedInTheirOrder) {
  boot("sv2");
  obey_switches();
  write({0x6081, 0}, "10000");
  play("pp", 1, 1063, 1071, "20000");
  play("pp", 1, 1085, 1089, "20000");
  play("hm", 6, 1211, 1215);
}

class HomingBits : public ManualSteps {
 protected:
  void home(const std::string& family, unsigned running, unsigned done) {
    boot(family);
    obey_switches();
    enable("6");
    write({0x6040, 0}, "31");
    EXPECT_EQ(status() & 0x1400U, running);
    wait(10s);
    EXPECT_EQ(status() & 0x1400U, done);
  }
};

TEST_F(HomingBits, OfTheSv2AreInvertedBitTwelveIsSetWhileItHomes) { home("sv2", 0x1000, 0x0400); }  // 1220
TEST_F(HomingBits, OfTheDa200FollowCia402) { home("da200", 0x0000, 0x1400); }                       // 574
TEST_F(HomingBits, OfTheGsd600FollowCia402) { home("gsd600", 0x0000, 0x1400); }                     // 7071

}  // namespace
}  // namespace servoctl::sim
