#include "traffic/ring_findings.hpp"

#include <gtest/gtest.h>

namespace servoctl::traffic {
namespace {

using Codes = std::vector<std::string>;

Codes codes_of_ring(const std::vector<Finding>& findings) {
  Codes out;
  for (const auto& f : findings) out.push_back(std::string(name(f.level)) + " " + f.code);
  return out;
}

RingFacts two_slaves() {
  RingFacts out;
  out.first.resize(2);
  out.first[0].look.ports[0] = {.link = true, .open = true, .signal = true};
  out.first[0].look.ports[1] = {.link = true, .open = true, .signal = true};
  out.first[1].look.ports[0] = {.link = true, .open = true, .signal = true};
  out.last = out.first;
  out.least = out.most = 2;
  out.sent = 100;
  out.length = std::chrono::seconds(2);
  return out;
}

TEST(RingFindings, OfAHealthyRingAreOk) {
  EXPECT_EQ(codes_of_ring(ring_findings(two_slaves())), Codes{"ok slaves"});
}

TEST(RingFindings, TellCountersThatGoOnFromThoseThatStand) {
  auto facts = two_slaves();
  facts.first[1].look.ports[0].bad_frames = facts.last[1].look.ports[0].bad_frames = 7;
  auto found = ring_findings(facts);
  EXPECT_EQ(codes_of_ring(found), (Codes{"ok slaves", "note port-had-errors"}));
  EXPECT_EQ(found[1].text, "node 2, port 0: 7 bad frames (CRC)");
  facts.last[1].look.ports[0].bad_frames = 9;
  found = ring_findings(facts);
  EXPECT_EQ(codes_of_ring(found), (Codes{"ok slaves", "fault port-errors"}));
  EXPECT_EQ(found[1].text, "node 2, port 0: 9 bad frames (CRC), and counting");
}

TEST(RingFindings, TellOfSlavesThatComeAndGoAndOfLostFrames) {
  auto facts = two_slaves();
  facts.least = 1;
  facts.lost = 3;
  const auto found = ring_findings(facts);
  EXPECT_EQ(codes_of_ring(found), (Codes{"fault slaves-come-and-go", "fault lost-frames"}));
  EXPECT_NE(found[0].mend.find("the cable between node 1 and node 2"), std::string::npos);
  EXPECT_EQ(found[1].text, "3 of 100 frames did not come back, 0 came back damaged");
  facts.least = 0;
  EXPECT_EQ(ring_findings(facts)[0].mend,
            "check power of node 1 and the cable between this machine and node 1");
}

TEST(RingFindings, TellOfAPortThatIsClosed) {
  auto facts = two_slaves();
  facts.last[1].look.ports[1] = {.link = true};
  EXPECT_EQ(codes_of_ring(ring_findings(facts)), (Codes{"ok slaves", "fault port-closed"}));
}

TEST(RingFindings, TellNoLinkFromNoAnswer) {
  const auto error = make_error(Errc::bus, "nobody answered");
  EXPECT_EQ(no_ring("coe:eth0", false, error).code, "no-link");
  EXPECT_EQ(no_ring("coe:eth0", true, error).code, "no-answer");
  EXPECT_EQ(no_ring("coe:local:a", std::nullopt, error).code, "no-answer");
}

}  // namespace
}  // namespace servoctl::traffic
