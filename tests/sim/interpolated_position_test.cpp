// Interpolated position as the GSD600 manual describes it (6198, 6211, 7413-7426, 7491-7496): absolute points
// by a synchronous RPDO, one at each SYNC, reached evenly in the period of 60C2h while bit 4 is set.
#include <fmt/format.h>

#include "base/bytes.hpp"
#include "manual_rows.hpp"
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class InterpolatedPosition : public RowTest {
 protected:
  void SetUp() override {
    boot("gsd600");
    write({0x60C2, 1}, "10");
    // RPDO2 carries 60C1h:01 (7479; the word is that of sub-index 01), by type 1 (6198).
    map("01");
    send("000#0101");
    enable("7");
  }
  void map(const std::string& type) {
    for (const auto& request : {std::string("601#2301140101030080"), std::string("601#2F01160000000000"),
                                std::string("601#230116012001C160"), std::string("601#2F01160001000000"),
                                "601#2F011402" + type + "000000", std::string("601#2301140101030000")})
      ASSERT_EQ(sdo(request).substr(0, 6), "581#60") << request;
  }
  void put(std::int32_t point) { send("301#" + to_hex(store_le(static_cast<std::uint32_t>(point), 4), "")); }
  void sync() { send("080#"); }
};

TEST_F(InterpolatedPosition, GoesFromPointToPointEvenlyInThePeriod) {
  control("31");
  EXPECT_TRUE(reaches(0x1000, 0x1000)) << "active (7424)";
  for (const int point : {1000, 3000, 6000}) {
    const auto before = read(kPosition);
    put(point);
    sync();
    wait(5ms);
    EXPECT_NEAR(read(kPosition), (before + point) / 2, 1) << point;
    EXPECT_EQ(read({0x606C, 0}), (point - before) * 100) << point;
    wait(5ms);
    EXPECT_EQ(read(kPosition), point);
  }
  wait(20ms);
  EXPECT_EQ(read(kPosition), 6000) << "it stands where no further point comes";
  EXPECT_EQ(read({0x606C, 0}), 0);
  EXPECT_TRUE(reaches(kReached, kReached));
}

TEST_F(InterpolatedPosition, NeedsTheSync) {
  control("31");
  put(1000);
  wait(100ms);
  EXPECT_EQ(read(kPosition), 0);
  sync();
  wait(10ms);
  EXPECT_EQ(read(kPosition), 1000);
}

TEST_F(InterpolatedPosition, NeedsASynchronousRpdo) {
  control("31");
  write(kPoint, "1000");
  sync();
  wait(100ms);
  EXPECT_EQ(read(kPosition), 0) << "by SDO";
  map("FF");
  put(2000);
  sync();
  wait(100ms);
  EXPECT_EQ(read(kPoint), 2000);
  EXPECT_EQ(read(kPosition), 0) << "by an RPDO of type 255";
}

TEST_F(InterpolatedPosition, NeedsBitFourAllTheTime) {  // 7425
  put(1000);
  sync();
  wait(100ms);
  EXPECT_EQ(read(kPosition), 0);
  control("31");
  put(100000);
  sync();
  wait(5ms);
  control("15");
  EXPECT_TRUE(reaches(0x0000, 0x1000));
  wait(5s);
  const auto stopped = read(kPosition);
  EXPECT_GT(stopped, 0);
  EXPECT_EQ(read({0x606C, 0}), 0);
  control("31");
  wait(100ms);
  EXPECT_EQ(read(kPosition), stopped) << "what was wanted before is forgotten";
}

TEST_F(InterpolatedPosition, PeriodChangesOnlyWhileItIsNotEnabled) {  // 6211
  EXPECT_EQ(sdo("601#2FC2600114000000"), "581#80C2600122000008");
  control("0");
  EXPECT_EQ(sdo("601#2FC2600114000000").substr(0, 6), "581#60");
  for (const char* word : {"6", "7", "15", "31"}) control(word);
  put(2000);
  sync();
  wait(10ms);
  EXPECT_NEAR(read(kPosition), 1000, 1);
  wait(10ms);
  EXPECT_EQ(read(kPosition), 2000);
}

TEST_F(InterpolatedPosition,
       PeriodIsLimited) {  // 7457: 1 to 20 ms; 60C2h:02 = -6 counts microseconds (CiA 402)
  control("0");
  write({0x60C2, 2}, "-6");
  for (const char* word : {"6", "7", "15", "31"}) control(word);
  put(2000);
  sync();
  wait(1ms);
  EXPECT_EQ(read(kPosition), 2000);
}

TEST_F(InterpolatedPosition, PeriodOutsideItsLimitsBecomesTheNearestOne) {  // 6211, 7425
  control("0");
  EXPECT_EQ(sdo("601#2FC2600119000000").substr(0, 6), "581#60");
  EXPECT_EQ(read({0x60C2, 1}), 20);
  EXPECT_EQ(sdo("601#2FC2600100000000").substr(0, 6), "581#60");
  EXPECT_EQ(read({0x60C2, 1}), 1);
}

TEST_F(InterpolatedPosition, HasNoPartInAMoveToATarget) {
  control("0");
  enable("1");
  write(kTarget, "100000");
  write({0x6081, 0}, "100000");
  write({0x6083, 0}, "100000");
  for (const char* word : {"15", "31"}) control(word);
  wait(100ms);
  EXPECT_NEAR(read({0x606C, 0}), 10000, 500) << "by its ramp";
}

}  // namespace
}  // namespace servoctl::sim
