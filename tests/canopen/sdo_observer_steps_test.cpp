// What the observer says of every single frame.
#include "canopen/sdo_observer.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using Kind = SdoStep::Kind;

class SdoObserverStepTest : public testing::Test {
 protected:
  SdoStep see(std::string_view text) {
    const auto seen = frame(text);
    return seen.id < 0x600 ? observer.on_server_frame(seen) : observer.on_client_frame(seen);
  }
  void see_all(std::initializer_list<std::string_view> lines) {
    for (const auto line : lines) (void)see(line);
  }
  SdoObserver observer;
};

TEST_F(SdoObserverStepTest, HasAKindForEveryCommand) {
  struct Row {
    std::string_view frame;
    Kind kind;
    bool block;
  };
  for (const auto& row : {Row{"602#0000000000000000", Kind::segment, false},
                          Row{"602#2100200109000000", Kind::write, false},
                          Row{"602#4000200100000000", Kind::read, false},
                          Row{"602#6000000000000000", Kind::next, false},
                          Row{"602#8000200100000008", Kind::abort, false},
                          Row{"602#A40020017F000000", Kind::read, true},
                          Row{"602#A100000000000000", Kind::end, true},
                          Row{"602#A2017F0000000000", Kind::next, true},
                          Row{"602#A300000000000000", Kind::next, true},
                          Row{"602#C600200109000000", Kind::write, true},
                          Row{"602#C100000000000000", Kind::end, true},
                          Row{"602#E000000000000000", Kind::unknown, true},
                          Row{"582#0000000000000000", Kind::segment, false},
                          Row{"582#2000000000000000", Kind::next, false},
                          Row{"582#4100200109000000", Kind::answer, false},
                          Row{"582#6000200100000000", Kind::acknowledge, false},
                          Row{"582#8000200100000008", Kind::abort, false},
                          Row{"582#A40020017F000000", Kind::acknowledge, true},
                          Row{"582#A100000000000000", Kind::end, true},
                          Row{"582#A2017F0000000000", Kind::next, true},
                          Row{"582#C600200109000000", Kind::answer, true},
                          Row{"582#C100000000000000", Kind::end, true},
                          Row{"582#E000000000000000", Kind::unknown, true}}) {
    observer = {};
    const auto step = see(row.frame);
    EXPECT_EQ(step.kind, row.kind) << row.frame;
    EXPECT_EQ(step.block, row.block) << row.frame;
    EXPECT_EQ(step.from_client, row.frame.front() == '6') << row.frame;
  }
  for (const auto* text : {"602#40002001000000", "582#43002001000000", "602#", "582#"})
    EXPECT_EQ(see(text).kind, Kind::unknown) << text;
}

TEST_F(SdoObserverStepTest, ReadsTheSizeOfAnObjectWhereItIs) {
  EXPECT_EQ(see("602#2100200109000000").announced, 9U);
  EXPECT_EQ(see("602#2000200109000000").announced, std::nullopt);
  EXPECT_EQ(see("582#4100200109000000").announced, 9U);
  EXPECT_EQ(see("582#4000200109000000").announced, std::nullopt);
  EXPECT_EQ(see("602#C200200109000000").announced, 9U);
  EXPECT_EQ(see("602#C400200109000000").announced, std::nullopt);
  EXPECT_EQ(see("582#C600200109000000").announced, 9U);
  EXPECT_EQ(see("582#C000200109000000").announced, std::nullopt);
  EXPECT_EQ(see("602#4000200109000000").announced, std::nullopt);
}

TEST_F(SdoObserverStepTest, TakesOneToFourBytesOfOneFrame) {
  const std::pair<const char*, Bytes> rows[] = {{"602#2300200101020304", {1, 2, 3, 4}},
                                                {"602#2700200101020304", {1, 2, 3}},
                                                {"582#4B00200101020304", {1, 2}},
                                                {"582#4F00200101020304", {1}},
                                                {"582#4E00200101020304", {1, 2, 3, 4}}};
  for (const auto& row : rows) {
    const auto step = see(row.first);
    EXPECT_EQ(step.data, row.second) << row.first;
    EXPECT_EQ(step.received, row.second.size()) << row.first;
    EXPECT_EQ(step.announced, std::nullopt) << row.first;
  }
}

TEST_F(SdoObserverStepTest, CountsTheBytesOfSegments) {
  EXPECT_EQ(see("582#0001020304050607").received, 0U);
  see_all({"602#4000200100000000", "582#410020010A000000"});
  EXPECT_EQ(see("582#0001020304050607").received, 7U);
  EXPECT_EQ(see("602#7000000000000000").received, 7U);
  const auto last = see("582#1908090A00000000");
  EXPECT_EQ(last.received, 10U);
  EXPECT_EQ(last.data->size(), 10U);
  EXPECT_EQ(see("582#0001020304050607").received, 7U);
  EXPECT_EQ(see("602#4000200100000000").received, 0U);
}

TEST_F(SdoObserverStepTest, ForgetsAnUnfinishedTransferAtTheNext) {
  see_all({"602#C600200110000000", "582#A40020017F000000", "602#0101010101010101", "602#8201010101010101"});
  see_all({"582#A2027F0000000000", "602#4000200100000000", "582#4100200102000000", "602#6000000000000000"});
  EXPECT_EQ(see("582#0B01020000000000").data, (Bytes{1, 2}));
  see_all({"602#C600200110000000", "582#A40020017F000000", "602#0101010101010101", "582#A40020017F000000"});
  EXPECT_EQ(see("602#8102020202020202").received, 7U);
  EXPECT_EQ(see("582#A2017F0000000000").received, 7U);
  EXPECT_EQ(see("602#C100000000000000").data, (Bytes(7, 2)));
}

TEST_F(SdoObserverStepTest, ForgetsEverythingAtAnAbort) {
  for (const auto* abort : {"602#8000200100000008", "582#8000200100000008"}) {
    see_all({"602#C600200110000000", "582#A40020017F000000", "602#0101010101010101"});
    const auto step = see(abort);
    EXPECT_EQ(step.abort_code, 0x0800'0000U);
    EXPECT_EQ(step.received, 7U);
    const auto behind = see("602#6000000000000000");
    EXPECT_EQ(behind.kind, Kind::next);
    EXPECT_FALSE(behind.object);
    EXPECT_EQ(behind.received, 0U);
    see_all({"602#A40020017F000000", "582#C200200110000000", "602#A300000000000000", "582#0101010101010101"});
    (void)see(abort);
    EXPECT_EQ(see("582#2000000000000000").kind, Kind::next);
  }
}

TEST_F(SdoObserverStepTest, TakesSegmentsOfABlockInTheirTurnOnly) {
  see_all({"602#A40020017F000000", "582#C200200110000000", "602#A300000000000000"});
  EXPECT_EQ(see("582#0101010101010101").received, 7U);
  EXPECT_EQ(see("582#0101010101010101").received, 7U);
  EXPECT_EQ(see("582#0303030303030303").received, 7U);
  EXPECT_EQ(see("582#0202020202020202").received, 14U);
  const auto acknowledged = see("602#A2017F0000000000");
  EXPECT_EQ(acknowledged.received, 7U);
  EXPECT_TRUE(acknowledged.from_client);
  EXPECT_EQ(see("582#8105050505050505").received, 14U);
  EXPECT_TRUE(see("582#8105050505050505").block);
  EXPECT_EQ(see("602#A2057F0000000000").received, 14U);
  EXPECT_EQ(see("582#8106060606060606").received, 21U);
  EXPECT_EQ(see("602#A2017F0000000000").received, 21U);
  const auto end = see("582#D900000000000000");
  EXPECT_EQ(end.received, 15U);
  EXPECT_EQ(end.data->size(), 15U);
  EXPECT_EQ(end.object, (ObjectAddress{0x2000, 1}));
  EXPECT_EQ(see("582#D900000000000000").received, 0U);
}

TEST_F(SdoObserverStepTest, EndsABlockWriteWithTheAcknowledgeOfItsLastSegment) {
  see_all({"602#C600200110000000", "582#A40020017F000000", "602#0101010101010101", "602#8202020202020202",
           "582#A2017F0000000000"});
  EXPECT_EQ(see("602#8102020202020202").kind, Kind::segment);
  EXPECT_EQ(see("602#C500000000000000").kind, Kind::segment);
  see_all({"582#A2017F0000000000"});
  const auto end = see("602#C500000000000000");
  EXPECT_EQ(end.kind, Kind::end);
  EXPECT_EQ(end.data->size(), 13U);
}

}  // namespace
}  // namespace servoctl::canopen
