// Servers that deviate from CiA 301, and leave no doubt about what they mean.
#include "canopen/sdo_habits.hpp"

#include "canopen/sdo_client.hpp"
#include "canopen/sdo_observer.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class SdoHabitTest : public testing::Test {
 protected:
  Result<Bytes> read(ObjectAddress object, std::initializer_list<std::string_view> lines,
                     Transfer transfer = Transfer::automatic) {
    client.start_upload(object, now, transfer);
    return played(lines);
  }
  Result<Bytes> write(ObjectAddress object, Bytes data, std::initializer_list<std::string_view> lines) {
    client.start_download(object, std::move(data), now);
    return played(lines);
  }
  Result<Bytes> played(std::initializer_list<std::string_view> lines) {
    play(client, now, lines);
    auto out = client.take_result();
    EXPECT_TRUE(out) << "the transfer has not ended";
    return out.value_or(fail(Errc::bug, "none"));
  }
  bool noted(SdoHabit habit) { return client.take_habits().test(static_cast<std::size_t>(habit)); }

  SdoClient client{2, 500ms};
  TimePoint now{1s};
};

TEST_F(SdoHabitTest, ShortAnswersAreTakenWhenTheCommandFits) {
  EXPECT_EQ(read({0x6041, 0}, {"> 602#4041600000000000", "< 582#4B4160003706"}).value(), (Bytes{0x37, 0x06}));
  EXPECT_TRUE(noted(SdoHabit::short_answer));
  EXPECT_FALSE(noted(SdoHabit::short_answer)) << "asked twice";
  EXPECT_EQ(read({0x6061, 0}, {"> 602#4061600000000000", "< 582#4F61600003"}).value(), (Bytes{3}));
  EXPECT_TRUE(write({0x6060, 0}, {3}, {"> 602#2F60600003000000", "< 582#60606000"}));
  EXPECT_TRUE(noted(SdoHabit::short_answer));
}

TEST_F(SdoHabitTest, AShortAnswerWithoutASizeHasAsManyBytesAsCame) {
  EXPECT_EQ(read({0x6041, 0}, {"> 602#4041600000000000", "< 582#424160003706"}).value(), (Bytes{0x37, 0x06}));
}

TEST_F(SdoHabitTest, ShortAnswersThatLackWhatTheirCommandNeedsAreRefused) {
  for (const auto* answer : {"< 582#4F416000", "< 582#4B41600037", "< 582#43416000370600", "< 582#80416000",
                             "< 582#41416000", "< 582#60"}) {
    client = SdoClient{2, 500ms};
    const auto out = read({0x6041, 0}, {"> 602#4041600000000000", answer, "> 602#8041600001000405"});
    ASSERT_FALSE(out) << answer;
    EXPECT_EQ(out.error().code, Errc::protocol) << answer;
    EXPECT_FALSE(noted(SdoHabit::short_answer)) << answer;
  }
}

TEST_F(SdoHabitTest, ShortSegmentsAreTaken) {
  EXPECT_EQ(read({0x1008, 0}, {"> 602#4008100000000000", "< 582#4108100009000000", "> 602#6000000000000000",
                               "< 582#0041424344454647", "> 602#7000000000000000", "< 582#1B4849"})
                .value(),
            (Bytes{'A', 'B', 'C', 'D', 'E', 'F', 'G', 'H', 'I'}));
  EXPECT_TRUE(write({0x1008, 0}, Bytes(8, 'x'),
                    {"> 602#2108100008000000", "< 582#60081000", "> 602#0078787878787878", "< 582#20",
                     "> 602#1D78000000000000", "< 582#30"}));
  EXPECT_TRUE(noted(SdoHabit::short_answer));
}

TEST_F(SdoHabitTest, FewerBytesThanAnnouncedAreTakenMoreAreNot) {
  EXPECT_EQ(read({0x1008, 0}, {"> 602#4008100000000000", "< 582#4108100020000000", "> 602#6000000000000000",
                               "< 582#0941424300000000"})
                .value(),
            (Bytes{'A', 'B', 'C'}));
  EXPECT_TRUE(noted(SdoHabit::announced_more));
  EXPECT_FALSE(
      read({0x1008, 0}, {"> 602#4008100000000000", "< 582#4108100002000000", "> 602#6000000000000000",
                         "< 582#0941424300000000", "> 602#8008100010000706"}));
  EXPECT_FALSE(noted(SdoHabit::announced_more));
}

TEST_F(SdoHabitTest, FourBytesForASmallerObjectAreCutWhereTheyAreZero) {
  const auto read_two = [&](std::string_view answer) {
    client.start_upload({0x6041, 0}, now, Transfer::automatic, 2);
    return played({"> 602#4041600000000000", answer}).value();
  };
  EXPECT_EQ(read_two("< 582#4341600037060000"), (Bytes{0x37, 0x06}));
  EXPECT_TRUE(noted(SdoHabit::always_four_bytes));
  EXPECT_EQ(read_two("< 582#4341600037060100"), (Bytes{0x37, 0x06, 0x01, 0x00}));
  EXPECT_EQ(read_two("< 582#4B41600037060100"), (Bytes{0x37, 0x06}));
  EXPECT_FALSE(noted(SdoHabit::always_four_bytes));
}

TEST_F(SdoHabitTest, AnAbortWithoutAnObjectIsForTheOnlyOpenRequest) {
  const auto refused = write({0x6060, 0}, {3}, {"> 602#2F60600003000000", "< 582#8000000030000906"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::sdo_abort);
  EXPECT_EQ(refused.error().abort_code, 0x06090030U);
  EXPECT_EQ(refused.error().object, (ObjectAddress{0x6060, 0}));
  EXPECT_TRUE(noted(SdoHabit::abort_without_object));
}

TEST_F(SdoHabitTest, AnAbortWithoutAnObjectIsNotTakenWhileAnEarlierRequestIsOpen) {
  (void)read({0x6041, 0}, {"> 602#4041600000000000", "+ 500ms", "> 602#8041600000000405"});
  client.start_download({0x6060, 0}, {3}, now);
  play(client, now, {"> 602#2F60600003000000", "< 582#8000000030000906"});
  EXPECT_FALSE(client.take_result()) << "it may be for 0x6041";
  EXPECT_FALSE(noted(SdoHabit::abort_without_object));
}

TEST(SdoObserver, ReadsShortAnswersAsTheClientDoes) {
  SdoObserver observer;
  (void)observer.on_client_frame(frame("602#4041600000000000"));
  const auto step = observer.on_server_frame(frame("582#4B4160003706"));
  EXPECT_EQ(step.kind, SdoStep::Kind::answer);
  EXPECT_EQ(step.data, (Bytes{0x37, 0x06}));
  EXPECT_EQ(observer.on_server_frame(frame("582#43416000370600")).kind, SdoStep::Kind::unknown);
}

TEST(SdoObserver, TellsWhatAnAbortWithoutAnObjectBelongsTo) {
  SdoObserver observer;
  (void)observer.on_client_frame(frame("602#2F60600003000000"));
  EXPECT_EQ(observer.on_server_frame(frame("582#8000000030000906")).object, (ObjectAddress{0x6060, 0}));
  EXPECT_EQ(observer.on_server_frame(frame("582#8000000030000906")).object, ObjectAddress{});
}

}  // namespace
}  // namespace servoctl::canopen
