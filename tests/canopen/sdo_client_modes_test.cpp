// The kinds of transfer the SDO client can be asked for, and what disturbs them.
#include "canopen/sdo_client.hpp"
#include "one_object.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class SdoClientModeTest : public testing::Test {
 protected:
  using Lines = std::initializer_list<std::string_view>;
  void upload(Lines lines, Transfer transfer = Transfer::automatic, std::size_t size = 0) {
    client.start_upload({0x2000, 1}, now, transfer, size);
    play(client, now, lines);
  }
  void download(std::size_t size, Transfer transfer, Lines lines) {
    client.start_download({0x2000, 1}, counted(size), now, transfer);
    play(client, now, lines);
  }
  /// Tells the client this; it must not answer.
  void tell(std::string_view text) {
    client.on_frame(frame(text), now);
    EXPECT_FALSE(client.take_frame()) << text;
  }
  Result<Bytes> result() {
    auto first = client.take_result();
    EXPECT_TRUE(first) << "the transfer has not ended";
    EXPECT_FALSE(client.busy());
    EXPECT_EQ(client.deadline(), kNever);
    return first ? *first : Result<Bytes>(fail(Errc::bug, "none"));
  }
  std::string failure() {
    const auto r = result();
    if (r) return "none";
    EXPECT_EQ(r.error().node, 2);
    EXPECT_EQ(r.error().object, (ObjectAddress{0x2000, 1}));
    constexpr std::string_view kStart = "node 2, object 0x2000:1: ";
    return r.error().message.text().substr(kStart.size());
  }

  SdoClient client{2, 500ms};
  TimePoint now{1s};
};

TEST_F(SdoClientModeTest, WritesAsItIsAskedTo) {
  struct Row {
    Transfer transfer;
    std::size_t size;
    std::string_view sent;
  };
  for (const auto& row :
       {Row{Transfer::automatic, 0, "602#2100200100000000"},
        Row{Transfer::automatic, 4, "602#2300200101020304"},
        Row{Transfer::automatic, 5, "602#2100200105000000"},
        Row{Transfer::automatic, 64, "602#2100200140000000"},
        Row{Transfer::automatic, 65, "602#C600200141000000"},
        Row{Transfer::domain, 2, "602#2B00200101020000"}, Row{Transfer::domain, 65, "602#C600200141000000"},
        Row{Transfer::expedited, 1, "602#2F00200101000000"},
        Row{Transfer::segmented, 2, "602#2100200102000000"},
        Row{Transfer::segmented, 65, "602#2100200141000000"},
        Row{Transfer::block, 2, "602#C600200102000000"}}) {
    SdoClient asked(2, 500ms);
    asked.start_download({0x2000, 1}, counted(row.size), now, row.transfer);
    EXPECT_EQ(can::to_string(*asked.take_frame()), row.sent);
    EXPECT_EQ(asked.total(), row.size);
    EXPECT_EQ(asked.deadline(), now + 500ms);
  }
}

TEST_F(SdoClientModeTest, ReadsAsItIsAskedTo) {
  for (const auto transfer : {Transfer::automatic, Transfer::expedited, Transfer::segmented}) {
    SdoClient asked(2, 500ms);
    asked.start_upload({0x2000, 1}, now, transfer);
    EXPECT_EQ(can::to_string(*asked.take_frame()), "602#4000200100000000");
  }
  upload({"> 602#4000200100000000", "< 582#4100200105000000", "> 602#8000200100000106"}, Transfer::expedited);
  EXPECT_EQ(failure(), "it does not answer this read in one frame");
  upload({"> 602#A40020017F000000", "< 582#4300200101020304", "> 602#8000200101000405"}, Transfer::block);
  EXPECT_EQ(failure(), "it answered the block transfer request with command 0x43");
}

TEST_F(SdoClientModeTest, TakesTheKnownSizeWhereTheAnswerSaysNone) {
  for (std::size_t size = 0; size < 6; ++size) {
    upload({"> 602#4000200100000000", "< 582#4200200101020304"}, Transfer::automatic, size);
    EXPECT_EQ(result()->size(), size >= 1 && size <= 3 ? size : 4) << size;
    upload({"> 602#4000200100000000", "< 582#4B00200101020304"}, Transfer::automatic, size);
    EXPECT_EQ(result()->size(), 2U);
  }
  upload({"> 602#4000200100000000", "< 582#4200200101020304"});
  EXPECT_EQ(result()->size(), 4U);
}

TEST_F(SdoClientModeTest, BeginsEveryTransferAnew) {
  const auto break_off = [&] {
    upload({"> 602#4000200100000000", "< 582#4100200108000000", "> 602#6000000000000000",
            "< 582#0001020304050607", "> 602#7000000000000000", "+ 500ms", "> 602#8000200100000405"});
    EXPECT_EQ(failure(), "no answer within 500 ms");
    EXPECT_EQ(client.total(), 8U);
  };
  for (const auto transfer : {Transfer::automatic, Transfer::domain}) {
    break_off();
    client.start_upload({0x2000, 1}, now, transfer);
    EXPECT_EQ(client.total(), std::nullopt);
    EXPECT_EQ(client.transferred(), 0U);
    (void)client.take_frame();
    play(client, now, {"< 582#4000200100000000", "> 602#6000000000000000", "< 582#0B01020000000000"});
    EXPECT_EQ(result().value(), counted(2));
  }
  break_off();
  download(8, Transfer::segmented,
           {"> 602#2100200108000000", "< 582#6000200100000000", "> 602#0001020304050607",
            "< 582#2000000000000000", "> 602#1D08000000000000", "< 582#3000000000000000"});
  EXPECT_TRUE(result());
  download(5, Transfer::segmented,
           {"> 602#2100200105000000", "< 582#6000200100000000", "> 602#0501020304050000",
            "< 582#2000000000000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoClientModeTest, FallsBackFromBlocksWithAllThatWasToBeWritten) {
  download(65, Transfer::block, {"> 602#C600200141000000", "< 582#8000200101000405"});
  EXPECT_EQ(failure(), "refused: command specifier not valid or unknown (abort 0x05040001)");
  download(66, Transfer::automatic,
           {"> 602#C600200142000000", "< 582#8000200101000405", "> 602#2100200142000000",
            "< 582#6000200100000000", "> 602#0001020304050607"});
  EXPECT_EQ(client.transferred(), 7U);
  EXPECT_EQ(client.total(), 66U);
}

TEST_F(SdoClientModeTest, CountsWhatWasTransferred) {
  upload({"> 602#4000200100000000", "< 582#410020010A000000", "> 602#6000000000000000",
          "< 582#0001020304050607", "> 602#7000000000000000"});
  EXPECT_EQ(client.transferred(), 7U);
  EXPECT_EQ(client.total(), 10U);
  tell("582#8000200100000008");
  EXPECT_FALSE(result());
  upload({"> 602#A40020017F000000", "< 582#C20020010A000000", "> 602#A300000000000000",
          "< 582#0101020304050607"},
         Transfer::domain);
  EXPECT_EQ(client.transferred(), 7U);
  EXPECT_EQ(client.total(), 10U);
  play(client, now, {"< 582#8208090A00000000", "> 602#A2027F0000000000"});
  EXPECT_EQ(client.transferred(), 14U);
  tell("582#8000200100000008");
  EXPECT_FALSE(result());
  download(10, Transfer::block,
           {"> 602#C60020010A000000", "< 582#A000200101000000", "> 602#0101020304050607"});
  EXPECT_EQ(client.transferred(), 0U);
  play(client, now, {"< 582#A201010000000000", "> 602#8108090A00000000"});
  EXPECT_EQ(client.transferred(), 7U);
  play(client, now, {"< 582#A201010000000000", "> 602#D100000000000000"});
  EXPECT_EQ(client.transferred(), 10U);
}

TEST_F(SdoClientModeTest, TakesNoMoreThanAnObjectCanHold) {
  upload({"> 602#4000200100000000", "< 582#4100200100000004", "> 602#6000000000000000"});
  tell("582#8000200100000008");
  EXPECT_FALSE(result());
  upload({"> 602#4000200100000000", "< 582#4100200101000004", "> 602#8000200105000405"});
  EXPECT_EQ(failure(), "it announces 67108865 bytes for this object");
  upload({"> 602#A40020017F000000", "< 582#C200200100000004", "> 602#A300000000000000"}, Transfer::domain);
  tell("582#8000200100000008");
  EXPECT_FALSE(result());
  upload({"> 602#A40020017F000000", "< 582#C200200101000004", "> 602#8000200105000405"}, Transfer::domain);
  EXPECT_EQ(failure(), "it announces 67108865 bytes for this object");
}

TEST_F(SdoClientModeTest, TakesTheFirstAnswerTwiceAtItsPlaceOnly) {
  upload({"> 602#4000200100000000", "< 582#410020010A000000", "> 602#6000000000000000"});
  tell("582#410020010A000000");
  play(client, now,
       {"< 582#0001020304050607", "> 602#7000000000000000", "< 582#410020010A000000",
        "> 602#8000200101000405"});
  EXPECT_EQ(failure(), "it answered a segment request with command 0x41");
  upload({"> 602#4000200100000000", "< 582#410020010A000000", "> 602#6000000000000000",
          "< 582#410120010A000000", "> 602#8000200101000405"});
  EXPECT_EQ(failure(), "it answered a segment request with command 0x41");
  download(15, Transfer::segmented,
           {"> 602#210020010F000000", "< 582#6000200100000000", "> 602#0001020304050607"});
  tell("582#6000200100000000");
  play(client, now,
       {"< 582#2000000000000000", "> 602#1008090A0B0C0D0E", "< 582#6000200100000000",
        "> 602#8000200101000405"});
  EXPECT_EQ(failure(), "it answered a segment with command 0x60");
  download(15, Transfer::segmented,
           {"> 602#210020010F000000", "< 582#6000200100000000", "> 602#0001020304050607",
            "< 582#6001200100000000", "> 602#8000200101000405"});
  EXPECT_EQ(failure(), "it answered a segment with command 0x60");
}

TEST_F(SdoClientModeTest, DoesNotTakeTheFirstAnswerBehindTheSecondSegment) {
  download(
      8, Transfer::segmented,
      {"> 602#2100200108000000", "< 582#6000200100000000", "> 602#0001020304050607", "< 582#2000000000000000",
       "> 602#1D08000000000000", "< 582#6000200100000000", "> 602#8000200101000405"});
  EXPECT_EQ(failure(), "it answered a segment with command 0x60");
}

TEST_F(SdoClientModeTest, SendsNoSegmentsOfATransferThatHasEnded) {
  client.start_download({0x2000, 1}, counted(9), now, Transfer::block);
  (void)client.take_frame();
  client.on_frame(frame("582#A00020017F000000"), now);
  EXPECT_TRUE(client.take_frame());
  tell("702#00");
  EXPECT_FALSE(result());
}

TEST_F(SdoClientModeTest, EndsWhenTheNodeRestarts) {
  upload({"> 602#4000200100000000"});
  tell("702#0000");
  tell("703#00");
  EXPECT_TRUE(client.busy());
  tell("702#00");
  play(client, now, {"+ 99ms"});
  EXPECT_TRUE(client.busy());
  play(client, now, {"+ 1ms"});
  EXPECT_EQ(failure(), "the node restarted (boot-up) in the middle of the transfer");
}

// A written 1017h restarts the heartbeat of some stacks, which begins with a boot-up message.
TEST_F(SdoClientModeTest, TakesTheAnswerBehindABootUp) {
  download(2, Transfer::automatic,
           {"> 602#2B00200101020000", "< 702#00", "+ 90ms", "< 582#6000200100000000"});
  EXPECT_TRUE(result());
  upload({"> 602#4000200100000000", "< 702#00", "< 582#4B00200101020000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoClientModeTest, TakesARefusalBehindABootUp) {
  upload({"> 602#4000200100000000", "< 702#00", "< 582#8000200100000206"});
  EXPECT_EQ(failure(), "refused: object does not exist in the object dictionary (abort 0x06020000)");
}

TEST_F(SdoClientModeTest, ForgetsABootUpThatWasAnswered) {
  upload(
      {"> 602#4000200100000000", "< 702#00", "< 582#4100200108000000", "> 602#6000000000000000", "+ 499ms"});
  EXPECT_TRUE(client.busy());
}

TEST_F(SdoClientModeTest, IgnoresFramesOfErrors) {
  upload({"> 602#4000200100000000"});
  auto error = frame("582#4B00200101020000");
  error.error = true;
  client.on_frame(error, now);
  EXPECT_TRUE(client.busy());
}

TEST_F(SdoClientModeTest, NamesAnotherMasterWhenNoAnswerComes) {
  upload({"> 602#4000200100000000"});
  tell("602#4000100000000000");
  EXPECT_TRUE(client.busy());
  play(client, now, {"+ 500ms", "> 602#8000200100000405"});
  EXPECT_EQ(result().error().hint.text(), "another master is also using SDO with this node");
  upload({"> 602#4000100000000000", "+ 500ms", "> 602#8000100000000405"});
  EXPECT_EQ(result().error().hint.text(), "");
  download(1, Transfer::automatic, {"> 602#2F00200101000000"});
  tell("602#4000100000000000");
  play(client, now, {"+ 500ms", "> 602#8000200100000405"});
  EXPECT_EQ(result().error().hint.text(), "another master is also using SDO with this node");
  download(1, Transfer::automatic, {"> 602#2F00200101000000", "+ 500ms", "> 602#8000200100000405"});
  EXPECT_EQ(result().error().hint.text(), "");
}

TEST_F(SdoClientModeTest, EndsWhenAnotherMasterUsesItsSegments) {
  const auto disturb = [&](bool ends) {
    tell("602#4000100000000000");
    EXPECT_EQ(client.busy(), !ends);
    if (ends) {
      EXPECT_EQ(failure(), "another master uses its SDO channel at the same time");
    }
  };
  upload({"> 602#4000200100000000", "< 582#410020010A000000", "> 602#6000000000000000"});
  disturb(true);
  download(9, Transfer::segmented,
           {"> 602#2100200109000000", "< 582#6000200100000000", "> 602#0001020304050607"});
  disturb(true);
  upload({"> 602#A40020017F000000"}, Transfer::domain);
  disturb(false);
  play(client, now, {"< 582#C20020010A000000", "> 602#A300000000000000"});
  disturb(true);
  download(9, Transfer::block, {"> 602#C600200109000000"});
  disturb(false);
  play(client, now, {"< 582#A00020017F000000", "> 602#0101020304050607", "> 602#8208090000000000"});
  disturb(true);
}

TEST_F(SdoClientModeTest, SaysThatABlockTransferWasNotAnswered) {
  upload({"> 602#A40020017F000000", "+ 500ms", "> 602#8000200100000405"}, Transfer::domain);
  const auto read = result();
  EXPECT_EQ(read.error().message.text(),
            "node 2, object 0x2000:1: no answer to the block transfer request within 500 ms");
  EXPECT_EQ(read.error().hint.text(), "if the node answers `read 0x1000`, try --transfer segmented");
  download(9, Transfer::block, {"> 602#C600200109000000", "+ 500ms", "> 602#8000200100000405"});
  EXPECT_EQ(failure(), "no answer to the block transfer request within 500 ms");
}

}  // namespace
}  // namespace servoctl::canopen
