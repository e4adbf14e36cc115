#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopen/sdo_client.hpp"
#include "one_object.hpp"
#include "slow_server.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

constexpr ObjectAddress kStatus{0x6041, 0};
constexpr ObjectAddress kMode{0x6060, 0};

class SdoLate : public testing::Test {
 protected:
  Result<Bytes> result() {
    auto end = client.take_result();
    EXPECT_TRUE(end) << "the transfer has not ended";
    return end.value_or(Result<Bytes>(fail(Errc::bug, "none")));
  }
  /// A read of 6060h that nobody answers in time.
  void read_in_vain() {
    client.start_upload(kMode, now);
    play(client, now, {"> 602#4060600000000000", "+ 500ms", "> 602#8060600000000405"});
    EXPECT_EQ(result().error().code, Errc::timeout);
  }
  void write_in_vain(std::string_view frame, std::uint8_t value) {
    client.start_download(kMode, {value}, now);
    play(client, now, {frame, "+ 500ms", "> 602#8060600000000405"});
    EXPECT_EQ(result().error().code, Errc::timeout);
  }

  SdoClient client{2, 500ms};
  TimePoint now{1s};
};

TEST_F(SdoLate, ALateAnswerToAReadDoesNotEndTheWriteBehindIt) {
  read_in_vain();
  client.start_download(kMode, {3}, now);
  play(client, now, {"> 602#2F60600003000000", "< 582#4F60600001000000", "< 582#6060600000000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoLate, ALateAnswerToAWriteDoesNotEndTheReadBehindIt) {
  write_in_vain("> 602#2F60600003000000", 3);
  client.start_upload(kMode, now);
  play(client, now, {"> 602#4060600000000000", "< 582#6060600000000000", "< 582#4F60600003000000"});
  EXPECT_EQ(result().value(), Bytes{3});
}

TEST_F(SdoLate, ALateAnswerIsNoneToTheNextReadOfTheObject) {
  read_in_vain();
  client.start_upload(kMode, now);
  play(client, now,
       {"> 602#4000100000000000", "< 582#4F60600001000000", "< 582#4300100092010200",
        "> 602#4060600000000000", "< 582#4F60600003000000"});
  EXPECT_EQ(result().value(), Bytes{3});
}

TEST_F(SdoLate, ACopyOfALateAnswerDoesNotTellThatNothingOlderIsOpen) {
  for (const auto* answer : {"< 582#4300100092010200", "< 582#8000100022000008"}) {
    SCOPED_TRACE(answer);
    read_in_vain();
    client.start_upload(kMode, now);
    play(client, now,
         {"> 602#4000100000000000", "< 582#4F60600001000000", "+ 500ms", "> 602#8000100000000405"});
    EXPECT_FALSE(result());
    read_in_vain();
    write_in_vain("> 602#2F60600003000000", 3);
    client.start_upload(kMode, now);
    play(client, now,
         {"> 602#4000100000000000", answer, answer, "< 582#4F60600001000000", "< 582#6060600000000000",
          answer, "> 602#4060600000000000", "< 582#4F60600003000000"});
    EXPECT_EQ(result().value(), Bytes{3});
    now += 1s;
  }
}

TEST_F(SdoLate, ALateAnswerIsOneToAFurtherTryOfItsRead) {
  read_in_vain();
  client.start_upload(kMode, now, Transfer::automatic, 0, true);
  play(client, now, {"> 602#4060600000000000", "< 582#4F60600001000000"});
  EXPECT_EQ(result().value(), Bytes{1});
  // The further try has not been answered yet.
  client.start_upload(kMode, now);
  play(client, now, {"> 602#4000100000000000"});
}

TEST_F(SdoLate, AConfirmationThatMayBeOfAnEarlierWriteLeavesOpenWhetherTheWriteWasDone) {
  write_in_vain("> 602#2F60600003000000", 3);
  client.start_download(kMode, {4}, now);
  play(client, now, {"> 602#2F60600004000000", "< 582#6060600000000000"});
  EXPECT_EQ(result().error().code, Errc::timeout) << "the caller reads the object then";
}

TEST_F(SdoLate, AConfirmationServesForTwoWritesOfTheSameValue) {
  write_in_vain("> 602#2F60600003000000", 3);
  client.start_download(kMode, {3}, now);
  play(client, now, {"> 602#2F60600003000000", "< 582#6060600000000000"});
  EXPECT_TRUE(result());
}

/// The one to the second write comes while a third one is under way.
TEST_F(SdoLate, TheSecondConfirmationOfTheSameValueIsNotThatOfTheNextWrite) {
  write_in_vain("> 602#2F60600003000000", 3);
  client.start_download(kMode, {3}, now);
  play(client, now, {"> 602#2F60600003000000", "< 582#6060600000000000"});
  EXPECT_TRUE(result());
  now += 100ms;
  client.start_download(kMode, {4}, now);
  play(client, now, {"> 602#2F60600004000000", "< 582#6060600000000000"});
  EXPECT_EQ(result().error().code, Errc::timeout);
}

TEST_F(SdoLate, AWriteInSegmentsThatWasRepeatedLeavesNothingOpen) {
  const Bytes text{1, 2, 3, 4, 5};
  client.start_download(kMode, text, now);
  play(client, now, {"> 602#2160600005000000", "+ 500ms", "> 602#8060600000000405"});
  EXPECT_FALSE(result());
  client.start_download(kMode, text, now);
  play(client, now,
       {"> 602#2160600005000000", "< 582#6060600000000000", "> 602#0501020304050000",
        "< 582#2000000000000000"});
  EXPECT_TRUE(result());
  client.start_download(kMode, {4}, now);
  play(client, now, {"> 602#2F60600004000000", "< 582#6060600000000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoLate, ARefusalThatComesLateIsNotThatOfTheWriteBehindIt) {
  read_in_vain();
  client.start_download(kMode, {3}, now);
  play(client, now, {"> 602#2F60600003000000", "< 582#8060600001000106", "< 582#6060600000000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoLate, ARefusalThatComesTwiceIsNotThatOfTheWriteBehindIt) {
  read_in_vain();
  client.start_download(kMode, {3}, now);
  play(client, now,
       {"> 602#2F60600003000000", "< 582#8060600001000106", "< 582#8060600001000106", "+ 500ms",
        "> 602#8060600000000405"});
  EXPECT_EQ(result().error().code, Errc::timeout);
  // It may still be answered.
  client.start_download(kMode, {4}, now);
  play(client, now, {"> 602#2F60600004000000", "< 582#6060600000000000"});
  EXPECT_EQ(result().error().code, Errc::timeout);
}

/// The second refusal is a copy, or for the first write: its confirmation is not taken for that of the
/// second.
TEST_F(SdoLate, ARefusalThatComesTwiceLeavesOpenTheWriteBehindIt) {
  client.on_frame(frame("602#4060600000000000"), now);
  write_in_vain("> 602#2F60600000000000", 0);
  client.on_frame(frame("602#2F60600000000000"), now);
  client.start_download(kMode, {1}, now);
  play(client, now,
       {"> 602#2F60600001000000", "< 582#8060600022000008", "< 582#8060600022000008",
        "< 582#6060600000000000", "< 582#6060600000000000", "< 582#8060600022000008"});
  EXPECT_EQ(result().error().code, Errc::timeout) << "the caller reads the object then";
}

TEST_F(SdoLate, AnotherMastersAnswerIsNotOurs) {
  client.on_frame(frame("602#2F60600005000000"), now);
  client.start_download(kMode, {4}, now);
  play(client, now, {"> 602#2F60600004000000", "< 582#6060600000000000"});
  EXPECT_EQ(result().error().code, Errc::timeout);
  client.start_upload(kStatus, now);
  client.on_frame(frame("602#4060600000000000"), now);
  play(client, now, {"> 602#4041600000000000", "< 582#4F60600005000000", "< 582#4B41600050020000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoLate, ARestartedNodeAnswersNothingThatIsOlder) {
  read_in_vain();
  client.on_frame(frame("702#00"), now);
  client.start_upload(kMode, now);
  play(client, now, {"> 602#4060600000000000", "< 582#4F60600003000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoLate, ALateAnswerIsPartOfTheMessageAboutSilence) {
  read_in_vain();
  client.start_upload(kStatus, now);
  play(client, now,
       {"> 602#4041600000000000", "+ 199ms", "< 582#4F60600001000000", "+ 500ms", "> 602#8041600000000405"});
  const auto end = result();
  EXPECT_EQ(end.error().code, Errc::timeout);
  EXPECT_EQ(end.error().message.text(),
            "node 2, object 0x6041:0: no answer within 500 ms; it answered an earlier request after 0.7 s");
  EXPECT_NE(end.error().hint.text().find("--timeout 2s"), std::string::npos) << end.error().hint.text();
}

TEST_F(SdoLate, AnAbortThatNamesAnotherObjectIsPartOfTheMessage) {
  client.start_upload(kStatus, now);
  play(client, now,
       {"> 602#4041600000000000", "< 582#8042600000000206", "+ 500ms", "> 602#8041600000000405"});
  const auto end = result();
  EXPECT_EQ(end.error().code, Errc::protocol);
  EXPECT_EQ(end.error().message.text(),
            "node 2, object 0x6041:0: no answer within 500 ms; it aborted with 0x06020000 and named object "
            "0x6042:0");
}

TEST_F(SdoLate, AnAnswerForAnotherObjectIsPartOfTheMessage) {
  client.start_upload(kStatus, now);
  play(client, now,
       {"> 602#4041600000000000", "< 582#4B42600000000000", "+ 500ms", "> 602#8041600000000405"});
  EXPECT_EQ(
      result().error().message.text(),
      "node 2, object 0x6041:0: no answer within 500 ms; it answered with command 0x4B for object 0x6042:0");
}

void hear_one(SdoClient& client, SlowServer& server, TimePoint now) {
  can::Frame answer{.id = 0x582, .size = 8};
  answer.data = server.coming.front().second;
  server.coming.pop_front();
  client.on_frame(answer, now);
}

/// Between two transfers: what has come is heard. An answer that comes twice comes before the next request.
void hear_all(SdoClient& client, SlowServer& server, TimePoint now) {
  while (!server.coming.empty() && server.coming.front().first <= now)
    hear_one(client, server, server.coming.front().first);
}

/// Runs a transfer to its end against a server.
Result<Bytes> run(SdoClient& client, SlowServer& server, TimePoint& now) {
  for (;;) {
    while (const auto sent = client.take_frame()) server.on_request(sent->data, now);
    if (auto end = client.take_result()) return *end;
    const auto due = server.coming.empty() ? kNever : server.coming.front().first;
    now = std::max(now, std::min(due, client.deadline()));
    // A time-out comes after what has arrived: both copies of an answer are heard before what is sent then.
    // Of the first copy that ever comes behind the next request no client can know.
    if (due <= now)
      hear_one(client, server, now);
    else
      client.on_time(now);
  }
}

SlowServer::Answering any_answering() {
  return {*rc::gen::weightedElement<Duration>({{6, 1ms}, {1, 400ms}, {2, 700ms}, {1, 1700ms}}),
          *rc::gen::weightedElement<int>({{6, 1}, {2, 2}, {1, 0}, {1, 3}}),
          *rc::gen::weightedElement<bool>({{7, false}, {1, true}})};
}

void foreign_request(SdoClient& client, SlowServer& server, TimePoint now) {
  can::Frame request{.id = 0x602, .size = 8};
  const bool writes = *rc::gen::arbitrary<bool>();
  request.data = {static_cast<std::uint8_t>(writes ? 0x2F : 0x40), 0x60, 0x60, 0,
                  *rc::gen::arbitrary<std::uint8_t>()};
  server.on_request(request.data, now);
  client.on_frame(request, now);
}

RC_GTEST_PROP(SdoClient, NoMixtureOfLateDoubledAndForeignAnswersTellsAnUntruth, ()) {
  SdoClient client(2, 500ms);
  SlowServer server;
  TimePoint now{1s};
  server.next = any_answering;
  server.set(kMode, 0, now);
  server.set(kStatus, 0, now);
  for (int step = *rc::gen::inRange(2, 12); step > 0; --step) {
    now += *rc::gen::element<Duration>(0ms, 1ms, 300ms);
    hear_all(client, server, now);
    const auto object = *rc::gen::element(kMode, kStatus);
    const auto value = *rc::gen::arbitrary<std::uint8_t>();
    if (*rc::gen::inRange(0, 4) == 0) server.set(object, value, now);
    if (*rc::gen::inRange(0, 4) == 0) foreign_request(client, server, now);
    const auto begun = now;
    if (*rc::gen::arbitrary<bool>()) {
      client.start_upload(object, now);
      auto end = run(client, server, now);
      if (!end && end.error().code == Errc::timeout) {
        client.start_upload(object, now, Transfer::automatic, 0, true);
        end = run(client, server, now);
      }
      if (end) RC_ASSERT(server.had(object, end->front(), begun));
      continue;
    }
    const auto before = server.values[object].size();
    client.start_download(object, {value}, now);
    const auto end = run(client, server, now);
    const auto& all = server.values[object];
    const bool done = std::any_of(all.begin() + static_cast<std::ptrdiff_t>(before), all.end(),
                                  [&](const auto& write) { return write.value == value; });
    const bool earlier =
        std::any_of(all.begin(), all.end(), [&](const auto& write) { return write.value == value; });
    if (end) RC_ASSERT(done || earlier);
    if (!end && end.error().code == Errc::sdo_abort) RC_ASSERT(!done);
  }
}

}  // namespace
}  // namespace servoctl::canopen
