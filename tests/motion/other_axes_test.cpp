// A second axis in a node: said before a motion, and part of the state in which a node is left.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/other_axes.hpp"
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

/// A simulated drive beside whose objects a second axis answers (6840h, 6841h).
class TwoAxes : public testing::Test {
 protected:
  explicit TwoAxes(std::string_view family = "cia402") : bench(family, 10000) {
    bench.bus->swallows = [this](const std::string& frame) {
      if (frame.rfind("601#4041" + page + "00", 0) == 0) {
        bench.bus->injected.push_back(
            fmt::format("581#4B41{}00{:02X}{:02X}0000", page, word & 0xFFU, word >> 8U));
        return true;
      }
      if (frame.rfind("601#2B40" + page + "00", 0) != 0) return false;
      commands.push_back(frame.substr(12, 4));
      if (obeys) word = 0x0250;
      bench.bus->injected.push_back("581#6040" + page + "0000000000");
      return true;
    };
  }
  std::vector<PreflightItem> look() {
    Motion motion(*bench.session, bench.profile(), 1, bench.options);
    EXPECT_TRUE(motion.prepare());
    auto items = motion.look_at_drive(false);
    return items ? *items : std::vector<PreflightItem>();
  }
  std::optional<PreflightItem> axes() {
    for (const auto& item : look())
      if (item.what == "axes") return item;
    return std::nullopt;
  }

  MotionBench bench;
  std::string page = "68";  ///< Of its objects: 6840h, 6841h.
  unsigned word = 0x0250;
  bool obeys = true;
  std::vector<std::string> commands;
};

TEST_F(TwoAxes, AreToldBeforeAMotionWithTheOneThatIsMeant) {
  const auto item = axes();
  ASSERT_TRUE(item);
  EXPECT_EQ(item->weight, PreflightItem::Weight::caution);
  EXPECT_EQ(
      item->text,
      "the device has 2 axes; this is about axis 1 (0x6041:0) only; axis 2 (0x6841:0) is in switch on disabled");
}

TEST_F(TwoAxes, OneThatIsEnergisedByOthersRefusesAMotion) {
  word = 0x0237;
  const auto item = axes();
  ASSERT_TRUE(item);
  EXPECT_EQ(item->weight, PreflightItem::Weight::stop);
}

TEST_F(TwoAxes, AreBothInTheStateThatAMotionLeaves) {
  bench.started = [this] { word = 0x0237; };
  const auto done = bench.jog(jog_for("60rpm", std::chrono::seconds(1)));
  ASSERT_TRUE(done.begun) << done.outcome.error().message.text();
  ASSERT_FALSE(done.end.left.empty());
  EXPECT_EQ(done.end.left.back(), "axis 2 (0x6841:0) is in operation enabled");
}

TEST_F(TwoAxes, LoseTheirPowerTogether) {
  word = 0x0237;
  auto others = other_axes(*bench.session, &bench.profile(), 1);
  ASSERT_EQ(others.size(), 1U);
  EXPECT_TRUE(stop_axes(*bench.session, 1, others, true));
  EXPECT_EQ(commands, (std::vector<std::string>{"0700", "0000"}));
  EXPECT_FALSE(others.front().may_be_energised());
}

TEST_F(TwoAxes, ANumberBetweenThemMayBeMissing) {
  page = "70";
  word = 0x0237;
  auto others = other_axes(*bench.session, &bench.profile(), 1);
  ASSERT_EQ(others.size(), 1U);
  EXPECT_EQ(others.front().text(), "axis 3 (0x7041:0) is in operation enabled");
  EXPECT_TRUE(stop_axes(*bench.session, 1, others, true));
  EXPECT_EQ(commands, (std::vector<std::string>{"0700", "0000"}));
}

TEST_F(TwoAxes, AnEmcyOfAnotherCauseLeavesNoneUnseen) {
  page = "70";
  word = 0x0237;
  bench.bus->swallows = [this, third = bench.bus->swallows](const std::string& frame) {
    if (frame.rfind("601#40416800", 0) != 0) return third(frame);
    bench.bus->injected.push_back("081#1082010000000000");
    bench.bus->injected.push_back("581#4B41680050020000");
    return true;
  };
  const auto others = other_axes(*bench.session, &bench.profile(), 1);
  ASSERT_EQ(others.size(), 2U);
  EXPECT_EQ(others.back().text(), "axis 3 (0x7041:0) is in operation enabled");
}

TEST_F(TwoAxes, OneThatDoesNotObeyIsAnError) {
  word = 0x0237;
  obeys = false;
  auto others = other_axes(*bench.session, &bench.profile(), 1);
  const auto stopped = stop_axes(*bench.session, 1, others, true);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().message.text(),
            "node 1: axis 2 (0x6841:0) is in operation enabled: it may be energised");
}

class AKnownFamily : public TwoAxes {
 protected:
  AKnownFamily() : TwoAxes("da200") {}
};

/// It would raise an alarm for an object that it does not have.
TEST_F(AKnownFamily, IsNotAskedForAnAxisThatItsDataDoNotHave) {
  EXPECT_FALSE(axes());
  for (const auto& frame : bench.bus->frames) EXPECT_EQ(frame.find("416800"), std::string::npos) << frame;
}

}  // namespace
}  // namespace servoctl::motion
