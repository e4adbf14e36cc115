#include "report/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace servoctl::report {
namespace {

TEST(Verdict, HoldsAFigureAgainstItsLimit) {
  EXPECT_EQ(at_most("a", "a", 3, 3).verdict, Verdict::passed);
  EXPECT_EQ(at_most("a", "a", 3.001, 3).verdict, Verdict::failed);
  EXPECT_EQ(at_least("a", "a", 3, 3).verdict, Verdict::passed);
  EXPECT_EQ(at_least("a", "a", 2.999, 3).verdict, Verdict::failed);
  EXPECT_EQ(at_most("a", "a", NAN, 3).verdict, Verdict::failed) << "what is no number has not passed";
  EXPECT_EQ(at_least("a", "a", NAN, 3).verdict, Verdict::failed);
}

TEST(Verdict, OfATestThatLookedAtNothingIsNotPassed) {
  TestResult result;
  EXPECT_FALSE(passed(result));
  result.criteria = {skipped("a", "a", "why")};
  EXPECT_FALSE(passed(result));
  result.criteria.push_back(at_most("b", "b", 0, 0));
  EXPECT_TRUE(passed(result));
  result.criteria.push_back(at_most("c", "c", 1, 0));
  EXPECT_FALSE(passed(result));
}

TEST(Verdict, IsToldInOneLine) {
  EXPECT_EQ(in_words(at_most("a", "a", 12.5, 100, "ms")), "12.5 ms, at most 100 ms");
  auto noted = at_least("a", "a", 3, 4);
  noted.note = "0x1017: 50 ms";
  EXPECT_EQ(in_words(noted), "3, at least 4; 0x1017: 50 ms");
  EXPECT_EQ(in_words(holds("a", "a", false, "only 0", "0, 1")), "only 0, wanted: 0, 1");
  EXPECT_EQ(in_words(skipped("a", "a", "not there")), "not there");
}

TEST(Junit, IsASuiteForEachTestAndACaseForEachCriterion) {
  TestResult result;
  result.test = "comm";
  result.node = 3;
  result.seconds = 1.25;
  result.criteria = {at_most("lost_answers", "lost answers", 2, 0), at_most("restarts", "restarts", 0, 0),
                     skipped("heartbeat", "heartbeat", "none <sent> & \"none\" wanted\x01")};
  EXPECT_EQ(junit_xml({result}),
            R"(<?xml version="1.0" encoding="UTF-8"?>
<testsuites name="servoctl" tests="3" failures="1" errors="0" time="1.250">
  <testsuite name="comm node 3" tests="3" failures="1" errors="0" skipped="1" time="1.250">
    <testcase classname="servoctl.comm.node-3" name="lost_answers" time="0">
      <failure message="2, at most 0" type="limit">lost answers: 2, at most 0</failure>
    </testcase>
    <testcase classname="servoctl.comm.node-3" name="restarts" time="0">
      <system-out>restarts: 0, at most 0</system-out>
    </testcase>
    <testcase classname="servoctl.comm.node-3" name="heartbeat" time="0">
      <skipped message="none &lt;sent&gt; &amp; &quot;none&quot; wanted\x01"/>
    </testcase>
  </testsuite>
</testsuites>
)");
}

}  // namespace
}  // namespace servoctl::report
