#include "canopen/sdo_observer.hpp"

#include "one_object.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using Kind = SdoStep::Kind;

class SdoObserverTest : public testing::Test {
 protected:
  SdoStep see(std::string_view text) {
    const auto seen = frame(text);
    return seen.id < 0x600 ? observer.on_server_frame(seen) : observer.on_client_frame(seen);
  }
  /// Sees all but the last, and answers with the last step.
  SdoStep see(std::initializer_list<std::string_view> lines) {
    SdoStep last;
    for (const auto line : lines) last = see(line);
    return last;
  }
  SdoObserver observer;
};

TEST_F(SdoObserverTest, FollowsAnExpeditedRead) {
  const auto asked = see("602#4041600000000000");
  EXPECT_EQ(asked.kind, Kind::read);
  EXPECT_TRUE(asked.from_client);
  EXPECT_EQ(asked.object, (ObjectAddress{0x6041, 0}));
  const auto answered = see("582#4B41600050020000");
  EXPECT_EQ(answered.kind, Kind::answer);
  EXPECT_FALSE(answered.from_client);
  EXPECT_EQ(answered.data, (Bytes{0x50, 0x02}));
}

TEST_F(SdoObserverTest, FollowsAnExpeditedWrite) {
  const auto written = see("602#2F60600003000000");
  EXPECT_EQ(written.kind, Kind::write);
  EXPECT_EQ(written.data, Bytes{3});
  EXPECT_EQ(see("582#6060600000000000").kind, Kind::acknowledge);
}

TEST_F(SdoObserverTest, PutsSegmentsTogetherBothWays) {
  EXPECT_EQ(see({"602#4008100000000000", "582#410810000A000000"}).announced, 10U);
  EXPECT_EQ(see({"602#6000000000000000", "582#00536572766F2D35"}).data, std::nullopt);
  const auto last = see({"602#7000000000000000", "582#1930303000000000"});
  EXPECT_EQ(last.kind, Kind::segment);
  EXPECT_EQ(last.object, (ObjectAddress{0x1008, 0}));
  EXPECT_EQ(last.data, text("Servo-5000"));
  EXPECT_EQ(see({"602#2100200005000000", "582#6000200000000000", "602#0568656C6C6F0000"}).data,
            text("hello"));
  EXPECT_EQ(see("582#2000000000000000").kind, Kind::next);
}

TEST_F(SdoObserverTest, PutsABlockReadTogetherWithItsRetransmission) {
  const auto end =
      see({"602#A4501F017F000000", "582#C2501F0115000000", "602#A300000000000000", "582#0131313131313131",
           "582#8333333333333333", "602#A2017F0000000000", "582#0132323232323232", "582#8233333333333333",
           "602#A2027F0000000000", "582#CD00000000000000"});
  EXPECT_EQ(end.kind, Kind::end);
  EXPECT_TRUE(end.block);
  EXPECT_EQ(end.data, text("111111122222223333"));
  EXPECT_EQ(see("602#A100000000000000").kind, Kind::end);
}

TEST_F(SdoObserverTest, PutsABlockWriteTogether) {
  const auto end = see({"602#C6501F0109000000", "582#A4501F017F000000", "602#0131323334353637",
                        "602#8238390000000000", "582#A2027F0000000000", "602#D5C3310000000000"});
  EXPECT_EQ(end.kind, Kind::end);
  EXPECT_EQ(end.data, text("123456789"));
  EXPECT_EQ(see("582#A100000000000000").kind, Kind::end);
}

TEST_F(SdoObserverTest, CountsOnlyWhatWasAcknowledgedOfEveryBlock) {
  const auto end =
      see({"602#C6501F0119000000", "582#A4501F0102000000", "602#0131313131313131", "602#0232323232323232",
           "582#A202020000000000", "602#0133333333333333", "602#8234343434000000", "582#A201020000000000",
           "602#8134343434000000", "582#A201020000000000", "602#CD00000000000000"});
  EXPECT_EQ(end.data, text("1111111222222233333334444"));
}

TEST_F(SdoObserverTest, ForgetsABlockThatWasLeftUnfinished) {
  const auto end =
      see({"602#A4501F017F000000", "582#C2501F0123000000", "602#A300000000000000", "582#0131313131313131",
           "582#0232323232323232", "602#A2027F0000000000", "582#0133333333333333", "582#8234343434343434",
           "602#A4502F017F000000", "582#C2502F010E000000", "602#A300000000000000", "582#0135353535353535",
           "602#A2017F0000000000", "582#8136363636363636", "602#A2017F0000000000", "582#C100000000000000"});
  EXPECT_EQ(end.data, text("55555556666666"));
}

TEST_F(SdoObserverTest, SaysWhichFramesBelongToABlockTransfer) {
  EXPECT_TRUE(see("602#A4501F017F000000").block);
  EXPECT_TRUE(see("602#A100000000000000").block);
  EXPECT_FALSE(see("602#4041600000000000").block);
  EXPECT_FALSE(see("602#A4").block);
}

TEST_F(SdoObserverTest, TakesFourBytesWhereNoSizeIsIndicated) {
  EXPECT_EQ(see("602#2E00200001020304").data, (Bytes{1, 2, 3, 4}));
}

TEST_F(SdoObserverTest, TellsWhoAbortedWhat) {
  const auto refused = see({"602#40FF5F0000000000", "582#80FF5F0000000206"});
  EXPECT_EQ(refused.kind, Kind::abort);
  EXPECT_EQ(refused.abort_code, 0x0602'0000U);
  EXPECT_EQ(refused.object, (ObjectAddress{0x5FFF, 0}));
  EXPECT_TRUE(see("602#8041600000000405").from_client);
}

TEST_F(SdoObserverTest, MakesNothingOfWhatItHasNotSeenTheBeginningOf) {
  const auto segment = see("582#0041424344454647");
  EXPECT_EQ(segment.kind, Kind::segment);
  EXPECT_FALSE(segment.object);
  EXPECT_FALSE(see("582#0941424300000000").data);
  EXPECT_EQ(see("602#E000000000000000").kind, Kind::unknown);
  EXPECT_EQ(see("582#40").kind, Kind::unknown);
}

}  // namespace
}  // namespace servoctl::canopen
