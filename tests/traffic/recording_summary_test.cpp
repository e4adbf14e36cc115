#include "traffic/recording_summary.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "report/value.hpp"

namespace servoctl::traffic {
namespace {

/// The summary of frames at times in ms, as JSON.
std::string summary_of(const std::vector<std::pair<int, std::string>>& frames) {
  const show::Desk desk;
  const std::map<std::uint8_t, const drive::Profile*> families;
  RecordingSummary summary(desk, families);
  for (const auto& [time, text] : frames)
    summary.add(std::chrono::milliseconds(time), *can::parse_frame(text));
  summary.end();
  return report::to_json(report::Value(summary.record("")));
}

bool has(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

TEST(RecordingSummary, ARequestWithoutAnAnswerIsCountedOnce) {
  const auto text = summary_of({{0, "601#4041600000000000"},  // not answered before the next one
                                {1000, "601#4041600000000000"},
                                {1005, "581#4B41600037060000"},  // answered
                                {2000, "601#4000100000000000"},  // given up by the master
                                {2500, "601#8000100000000405"},
                                {3000, "601#4018100100000000"},  // not answered to the end
                                {9000, "701#05"}});
  EXPECT_TRUE(has(text, R"("unanswered":3)")) << text;
  EXPECT_TRUE(has(text, R"("answer_max_ms":5)")) << text;
  EXPECT_TRUE(has(text, R"("state":"operation enabled")")) << text;
  EXPECT_TRUE(has(text, R"("aborts":1)")) << text;
}

TEST(RecordingSummary, ARequestJustBeforeTheEndMayStillBeAnswered) {
  EXPECT_TRUE(
      has(summary_of({{0, "701#05"}, {10, "601#4041600000000000"}, {20, "701#05"}}), R"("unanswered":0)"));
}

TEST(RecordingSummary, ABootUpEndsWhatWasKnownOfTheState) {
  const auto text =
      summary_of({{0, "581#4B41600037060000"}, {10, "701#00"}, {1000, "701#05"}, {3000, "701#05"}});
  EXPECT_TRUE(has(text, R"("nmt":"operational","state":null,"boot_ups":1,"heartbeat_ms":2000)")) << text;
  EXPECT_TRUE(has(text, R"("gap_ms":2000,"gap_at_s":1)")) << text;
}

TEST(RecordingSummary, WithoutTimesThereAreNoPeriods) {
  EXPECT_TRUE(
      has(summary_of({{0, "701#05"}, {0, "701#05"}}), R"("seconds":null,"gap_ms":null,"gap_at_s":null)"));
}

}  // namespace
}  // namespace servoctl::traffic
