// What the SDO server takes and gives at the edges, and what it makes of frames out of place.
#include <map>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_server.hpp"
#include "one_object.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class OneObject final : public ObjectStore {
 public:
  std::uint32_t read(ObjectAddress, Bytes& out) override {
    out = value;
    return refusal;
  }
  std::uint32_t write(ObjectAddress, ByteSpan data) override {
    if (refusal == 0) value.assign(data.begin(), data.end());
    return refusal;
  }
  Bytes value;
  std::uint32_t refusal = 0;
};

class SdoServerLimitTest : public testing::Test {
 protected:
  using Lines = std::initializer_list<std::string_view>;
  /// Each of these must send what stands behind it and nothing else.
  void steps(std::initializer_list<Lines> all) {
    for (const auto& lines : all) play(server, now, lines);
  }
  OneObject object;
  SdoServer server{2, object, {}};
  TimePoint now{1s};
};

TEST_F(SdoServerLimitTest, AnswersPlainFramesToItsNodeOnly) {
  object.value = {1};
  std::vector<can::Frame> flagged(3, frame("602#4000200100000000"));
  flagged[0].extended = true;
  flagged[1].remote = true;
  flagged[2].error = true;
  for (const auto& other : flagged) server.on_frame(other, now);
  EXPECT_FALSE(server.take_frame());
  steps({{"< 601#4000200100000000"},
         {"< 602#40002001000000"},
         {"< 602#4000200100000000", "> 582#4F00200101000000"}});
}

TEST_F(SdoServerLimitTest, GivesAnyNumberOfBytes) {
  object.value = {};
  steps({{"< 602#4000200100000000", "> 582#4100200100000000", "< 602#6000000000000000",
          "> 582#0F00000000000000"}});
  object.value = counted(5);
  steps({{"< 602#4000200100000000", "> 582#4100200105000000", "< 602#6000000000000000",
          "> 582#0501020304050000"}});
  EXPECT_EQ(server.deadline(), kNever);
  object.value = counted(7);
  steps({{"< 602#4000200100000000", "> 582#4100200107000000", "< 602#6000000000000000",
          "> 582#0101020304050607"}});
  object.value = counted(15);
  steps({{"< 602#4000200100000000", "> 582#410020010F000000", "< 602#6000000000000000",
          "> 582#0001020304050607"},
         {"< 602#7000000000000000", "> 582#1008090A0B0C0D0E", "< 602#6000000000000000",
          "> 582#0D0F000000000000"},
         {"< 602#7000000000000000", "> 582#8000200101000405"}});
}

TEST_F(SdoServerLimitTest, AbortsAReadWithAWrongToggleBit) {
  object.value = counted(15);
  steps({{"< 602#4000200100000000", "> 582#410020010F000000"},
         {"< 602#7000000000000000", "> 582#8000200100000305"}});
  EXPECT_EQ(server.deadline(), kNever);
}

TEST_F(SdoServerLimitTest, TakesADownloadOfUnknownLength) {
  steps({{"< 602#2000200100000000", "> 582#6000200100000000"},
         {"< 602#0001020304050607", "> 582#2000000000000000"},
         {"< 602#1308090A0B0C0D00", "> 582#3000000000000000"}});
  EXPECT_EQ(object.value, counted(13));
  EXPECT_EQ(server.deadline(), kNever);
}

TEST_F(SdoServerLimitTest, KeepsNothingOfATransferThatWasBrokenOff) {
  for (const auto* begin : {"< 602#2100200109000000", "< 602#2000200100000000"}) {
    steps({{"< 602#2100200108000000", "> 582#6000200100000000"},
           {"< 602#0009090909090909", "> 582#2000000000000000"}});
    steps({{begin, "> 582#6000200100000000"},
           {"< 602#0001020304050607", "> 582#2000000000000000"},
           {"< 602#1B08090000000000", "> 582#3000000000000000"}});
    EXPECT_EQ(object.value, counted(9));
  }
}

TEST_F(SdoServerLimitTest, BeginsAReadAnewThatIsAskedForAgain) {
  object.value = counted(9);
  for (int times = 0; times < 2; ++times)
    steps({{"< 602#4000200100000000", "> 582#4100200109000000"},
           {"< 602#6000000000000000", "> 582#0001020304050607"}});
  object.value = {1};
  steps({{"< 602#4000200100000000", "> 582#4F00200101000000"},
         {"< 602#7000000000000000", "> 582#8000200101000405"}});
  EXPECT_EQ(server.deadline(), kNever);
}

TEST_F(SdoServerLimitTest, WaitsForTheFirstRequestOfASegment) {
  object.value = counted(9);
  steps({{"< 602#4000200100000000", "> 582#4100200109000000"},
         {"+ 999ms"},
         {"+ 1ms", "> 582#8000200100000405"}});
}

TEST_F(SdoServerLimitTest, WaitsAnewAfterEverySegment) {
  object.value = counted(15);
  steps({{"< 602#4000200100000000", "> 582#410020010F000000"},
         {"+ 900ms"},
         {"< 602#6000000000000000", "> 582#0001020304050607"}});
  EXPECT_EQ(server.deadline(), now + 1s);
  steps({{"< 602#210020010F000000", "> 582#6000200100000000"},
         {"+ 900ms"},
         {"< 602#0001020304050607", "> 582#2000000000000000"}});
  EXPECT_EQ(server.deadline(), now + 1s);
}

TEST_F(SdoServerLimitTest, PassesTheRefusalOfALongObjectOn) {
  object.refusal = sdo_abort::kReadOnly;
  steps({{"< 602#2100200105000000", "> 582#6000200100000000"},
         {"< 602#0501020304050000", "> 582#8000200102000106"}});
  EXPECT_EQ(server.deadline(), kNever);
}

TEST_F(SdoServerLimitTest, RefusesADownloadThatNoMemoryHolds) {
  steps({{"< 602#2100200100000001", "> 582#6000200100000000"},
         {"< 602#2100200101000001", "> 582#8000200105000405"}});
  steps({{"< 602#C200200100000001", "> 582#A40020017F000000"}, {"< 602#8000200100000000"}});
  steps({{"< 602#C200200101000001", "> 582#8000200105000405"}});
}

TEST_F(SdoServerLimitTest, RefusesImpossibleBlocks) {
  object.value = counted(9);
  steps({{"< 602#A400200100000000", "> 582#8000200102000405"},
         {"< 602#A400200180000000", "> 582#8000200102000405"}});
  object.refusal = sdo_abort::kNoObject;
  steps({{"< 602#A40020017F000000", "> 582#8000200100000206"}});
}

TEST_F(SdoServerLimitTest, AnswersOrdinarilyUpToTheSwitchThreshold) {
  object.value = counted(5);
  steps({{"< 602#A40020017F050000", "> 582#4100200105000000"},
         {"< 602#6000000000000000", "> 582#0501020304050000"}});
  steps({{"< 602#A40020017F040000", "> 582#C600200105000000"}, {"< 602#8000200100000000"}});
  object.value = {};
  steps({{"< 602#A40020017F000000", "> 582#C600200100000000"}});
}

TEST_F(SdoServerLimitTest, MakesACrcWhenBothSidesDo) {
  object.value = counted(2);
  for (const bool client : {false, true})
    for (const bool own : {false, true}) {
      SdoServer::Options options;
      options.crc = own;
      SdoServer one(2, object, options);
      play(one, now,
           {client ? "< 602#A40020017F000000" : "< 602#A00020017F000000",
            own ? "> 582#C600200102000000" : "> 582#C200200102000000", "< 602#A300000000000000",
            "> 582#8101020000000000", "< 602#A2017F0000000000",
            client && own ? "> 582#D573130000000000" : "> 582#D500000000000000", "< 602#A100000000000000"});
      EXPECT_EQ(one.deadline(), kNever);
      play(one, now,
           {client ? "< 602#C600200102000000" : "< 602#C200200102000000",
            own ? "> 582#A40020017F000000" : "> 582#A00020017F000000", "< 602#8101020000000000",
            "> 582#A2017F0000000000", "< 602#D500000000000000",
            client && own ? "> 582#8000200104000405" : "> 582#A100000000000000"});
    }
}

TEST_F(SdoServerLimitTest, TakesBlocksOfItsOwnSize) {
  SdoServer::Options options;
  options.block_size = 2;
  SdoServer small(2, object, options);
  play(small, now, {"< 602#C000200100000000", "> 582#A400200102000000", "< 602#0101020304050607"});
  play(small, now, {"< 602#0208090A0B0C0D0E", "> 582#A202020000000000"});
  play(small, now, {"< 602#810F000000000000", "> 582#A201020000000000"});
  play(small, now, {"< 602#D900000000000000", "> 582#A100000000000000"});
  EXPECT_EQ(object.value, counted(15));
}

TEST_F(SdoServerLimitTest, AsksOnceForTheLostEndOfABlock) {
  steps({{"< 602#C200200115000000", "> 582#A40020017F000000"},
         {"< 602#0101020304050607"},
         {"+ 249ms"},
         {"+ 1ms", "> 582#A2017F0000000000"},
         {"+ 999ms"},
         {"< 602#0108090A0B0C0D0E"},
         {"+ 999ms"},
         {"+ 1ms", "> 582#8000200100000405"}});
  EXPECT_EQ(server.deadline(), kNever);
  steps({{"< 602#C200200115000000", "> 582#A40020017F000000"},
         {"< 602#0101020304050607"},
         {"+ 250ms", "> 582#A2017F0000000000"},
         {"< 602#0108090A0B0C0D0E"},
         {"< 602#820F101112131415", "> 582#A2027F0000000000"},
         {"< 602#C100000000000000", "> 582#A100000000000000"}});
  EXPECT_EQ(object.value, counted(21));
  steps({{"< 602#C200200115000000", "> 582#A40020017F000000"},
         {"+ 999ms"},
         {"+ 1ms", "> 582#8000200100000405"}});
}

TEST_F(SdoServerLimitTest, RefusesMoreBytesInABlockThanAnnounced) {
  steps({{"< 602#C200200107000000", "> 582#A40020017F000000"},
         {"< 602#0101020304050607"},
         {"< 602#8200000000000000", "> 582#A2027F0000000000"},
         {"< 602#DD00000000000000", "> 582#A100000000000000"}});
  EXPECT_EQ(object.value, counted(7));
  steps({{"< 602#C200200106000000", "> 582#A40020017F000000"},
         {"< 602#0101020304050607"},
         {"< 602#8200000000000000", "> 582#8000200112000706"}});
  steps({{"< 602#C200200106000000", "> 582#A40020017F000000"},
         {"< 602#8101020304050607", "> 582#A2017F0000000000"},
         {"< 602#C100000000000000", "> 582#8000200112000706"}});
}

TEST_F(SdoServerLimitTest, TakesEachStepOfABlockReadAtItsPlaceOnly) {
  object.value = counted(9);
  const auto refused = [&](std::string_view text) { play(server, now, {text, "> 582#8000200101000405"}); };
  const Lines start = {"< 602#A40020017F000000", "> 582#C600200109000000"};
  const Lines data = {"< 602#A300000000000000", "> 582#0101020304050607", "> 582#8208090000000000"};
  for (const auto* early : {"< 602#A2027F0000000000", "< 602#A100000000000000"}) {
    steps({start});
    refused(early);
  }
  steps({start, data, {"< 602#A300000000000000"}});
  refused("< 602#A100000000000000");
  refused("< 602#A300000000000000");
  refused("< 602#C100000000000000");
  steps({start, data});
  EXPECT_EQ(server.deadline(), TimePoint::min());
  server.on_frame(frame("602#A2007F0000000000"), now);
  EXPECT_EQ(server.deadline(), kNever);
  steps({{"> 582#0101020304050607", "> 582#8208090000000000"}});
  server.on_frame(frame("602#A2027F0000000000"), now);
  EXPECT_EQ(server.deadline(), now + 1s);
  EXPECT_TRUE(server.take_frame());
  steps({{"< 602#A2027F0000000000"}});
  refused("< 602#A300000000000000");
  steps({start, data, {"< 602#A2037F0000000000", "> 582#8000200103000405"}});
}

}  // namespace
}  // namespace servoctl::canopen
