#include "canopen/sdo_block.hpp"

#include <gtest/gtest.h>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_client.hpp"
#include "one_object.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class BlockServerTest : public testing::Test {
 protected:
  OneObject object;
  SdoServer server{2, object, {}};
  TimePoint now{1s};
};

TEST_F(BlockServerTest, GivesABlock) {
  object.value = text("123456789");
  play(server, now,
       {"< 602#A4501F017F000000", "> 582#C6501F0109000000", "< 602#A300000000000000",
        "> 582#0131323334353637", "> 582#8238390000000000", "< 602#A2027F0000000000",
        "> 582#D5C3310000000000", "< 602#A100000000000000"});
  EXPECT_EQ(server.deadline(), kNever);
}

TEST_F(BlockServerTest, AnswersOrdinarilyBelowTheSwitchThreshold) {
  object.value = {1, 2};
  play(server, now, {"< 602#A4501F017F020000", "> 582#4B501F0101020000"});
}

TEST_F(BlockServerTest, TakesABlockAndWritesOnce) {
  play(server, now,
       {"< 602#C6501F0109000000", "> 582#A4501F017F000000", "< 602#0131323334353637",
        "< 602#8238390000000000", "> 582#A2027F0000000000", "< 602#8238390000000000",
        "< 602#D5C3310000000000", "> 582#A100000000000000"});
  EXPECT_EQ(object.value, text("123456789"));
  EXPECT_EQ(object.writes, 1);
}

TEST_F(BlockServerTest, RefusesAWrongCrcAWrongSizeAndItsObject) {
  play(
      server, now,
      {"< 602#C6501F0109000000", "> 582#A4501F017F000000", "< 602#0131323334353637", "< 602#8238390000000000",
       "> 582#A2027F0000000000", "< 602#D5C3320000000000", "> 582#80501F0104000405"});
  play(
      server, now,
      {"< 602#C2501F010A000000", "> 582#A4501F017F000000", "< 602#0131323334353637", "< 602#8238390000000000",
       "> 582#A2027F0000000000", "< 602#D500000000000000", "> 582#80501F0113000706"});
  object.refusal = sdo_abort::kReadOnly;
  play(
      server, now,
      {"< 602#C2501F0109000000", "> 582#A4501F017F000000", "< 602#0131323334353637", "< 602#8238390000000000",
       "> 582#A2027F0000000000", "< 602#D500000000000000", "> 582#80501F0102000106"});
  EXPECT_EQ(object.writes, 0);
}

TEST_F(BlockServerTest, RefusesBlocksWhenItHasNone) {
  SdoServer::Options options;
  options.block = false;
  SdoServer plain(2, object, options);
  play(plain, now, {"< 602#A4501F017F000000", "> 582#80501F0101000405"});
  play(plain, now, {"< 602#C6501F0109000000", "> 582#80501F0101000405"});
}

TEST_F(BlockServerTest, GivesUpWhenTheClientFallsSilent) {
  object.value = counted(20);
  play(
      server, now,
      {"< 602#A4501F017F000000", "> 582#C6501F0114000000", "< 602#A300000000000000", "> 582#0101020304050607",
       "> 582#0208090A0B0C0D0E", "> 582#830F101112131400", "+ 0ms", "+ 1s", "> 582#80501F0100000405"});
}

TEST_F(BlockServerTest, GivesTheClientItsFullTimeForEveryAnswer) {
  object.value = text("123456789");
  play(server, now,
       {"< 602#A4501F017F000000", "> 582#C6501F0109000000", "+ 900ms", "< 602#A300000000000000",
        "> 582#0131323334353637", "> 582#8238390000000000", "+ 0ms", "+ 900ms", "< 602#A2027F0000000000",
        "> 582#D5C3310000000000", "+ 999ms", "+ 1ms", "> 582#80501F0100000405"});
  play(server, now,
       {"< 602#C6501F0109000000", "> 582#A4501F017F000000", "+ 999ms", "+ 1ms", "> 582#80501F0100000405"});
}

}  // namespace
}  // namespace servoctl::canopen
