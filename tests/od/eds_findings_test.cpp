#include "od/eds_findings.hpp"

#include <gtest/gtest.h>

namespace servoctl::od {
namespace {

void add(Findings& findings, const char* rule, std::uint32_t line, const char* message = "m") {
  findings.add(Severity::warning, line, 3, rule, message, "r");
}

TEST(Findings, StandInRisingLineAndElseInTheirOrder) {
  Findings findings;
  add(findings, "b", 7, "first");
  add(findings, "a", 2, "second");
  add(findings, "a", 7, "third");
  const IniKey key{"k", "v", 7, 5};
  findings.error(key, "e", "fourth", "r");
  findings.warn(key, "w", "fifth", "r");
  std::string order;
  const auto all = findings.take();
  for (const auto& d : all) order += d.message + " ";
  EXPECT_EQ(order, "second first third fourth fifth ");
  EXPECT_EQ(all[0].column, 3U);
  EXPECT_EQ(all[3].severity, Severity::error);
  EXPECT_EQ(all[3].column, 5U);
  EXPECT_EQ(all[4].severity, Severity::warning);
  EXPECT_EQ(all[4].line, 7U);
}

TEST(Findings, OfOneRuleAreCountedAboveTheLimit) {
  for (const std::uint32_t more : {0U, 1U, 2U}) {
    Findings findings;
    for (std::uint32_t i = 0; i < Findings::kMostOfARule; ++i) {
      EXPECT_FALSE(findings.enough_of("a"));
      add(findings, "a", 9);
    }
    if (more > 0) {
      EXPECT_TRUE(findings.enough_of("a"));
    }
    if (more > 1) add(findings, "a", 9);
    add(findings, "b", 30);
    const auto all = findings.take();
    ASSERT_EQ(all.size(), Findings::kMostOfARule + 1 + (more > 0 ? 1 : 0));
    if (more == 0) continue;
    EXPECT_EQ(all.back().rule, "a");
    EXPECT_EQ(all.back().line, 30U);
    EXPECT_EQ(all.back().column, 1U);
    EXPECT_EQ(all.back().count, more);
    EXPECT_EQ(all.back().severity, Severity::warning);
    EXPECT_EQ(all.back().message,
              more == 1 ? "1 more of this rule is left out" : "2 more of this rule are left out");
  }
  EXPECT_TRUE(Findings().take().empty());
}

}  // namespace
}  // namespace servoctl::od
