#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "coe_client_fixture.hpp"
#include "tests/canopen/slow_server.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;
using canopen::SlowServer;

constexpr ObjectAddress kLateMode{0x6060, 0};
constexpr ObjectAddress kLateStatus{0x6041, 0};

TEST_F(CoeClientTest, ALateAnswerIsNoneToTheNextReadOfTheObject) {
  upload(kLateMode, {"> 00204060600000000000", "+ 500ms", "> 00208060600000000405"});
  EXPECT_EQ(result().error().code, Errc::timeout);
  upload(kLateMode, {"> 00204000100000000000", "< 00304F60600001000000", "< 00304300100092010200",
                     "> 00204060600000000000", "< 00304F60600003000000"});
  EXPECT_EQ(data(), "03");
}

TEST_F(CoeClientTest, AConfirmationThatMayBeOfAnEarlierWriteLeavesOpenWhetherTheWriteWasDone) {
  download(kLateMode, {3}, {"> 00202F60600003000000", "+ 500ms", "> 00208060600000000405"});
  EXPECT_EQ(result().error().code, Errc::timeout);
  download(kLateMode, {4}, {"> 00202F60600004000000", "< 00306060600000000000"});
  EXPECT_EQ(result().error().code, Errc::timeout);
}

/// Another object is read to find out what is still open. A copy of its earlier answer is not the present
/// one: the answer to the read before the write would be taken for the value after it.
TEST_F(CoeClientTest, ACopyOfALateAnswerDoesNotTellThatNothingOlderIsOpen) {
  upload(kLateMode, {"> 00204060600000000000", "+ 500ms", "> 00208060600000000405"});
  EXPECT_FALSE(result());
  upload(kLateMode, {"> 00204000100000000000", "< 00304F60600001000000", "< 00304F60600001000000", "+ 500ms",
                     "> 00208000100000000405"});
  EXPECT_FALSE(result());
  upload(kLateMode, {"> 00204060600000000000", "+ 500ms", "> 00208060600000000405"});
  EXPECT_FALSE(result());
  download(kLateMode, {3}, {"> 00202F60600003000000", "+ 500ms", "> 00208060600000000405"});
  EXPECT_FALSE(result());
  upload(kLateMode, {"> 00204000100000000000", "< 00304300100092010200", "< 00304300100092010200",
                     "< 00304F60600001000000", "< 00306060600000000000", "< 00304300100092010200",
                     "> 00204060600000000000", "< 00304F60600003000000"});
  EXPECT_EQ(data(), "03");
}

/// The one to the second write comes while a third one is under way.
TEST_F(CoeClientTest, TheSecondConfirmationOfTheSameValueIsNotThatOfTheNextWrite) {
  download(kLateMode, {3}, {"> 00202F60600003000000", "+ 500ms", "> 00208060600000000405"});
  EXPECT_FALSE(result());
  download(kLateMode, {3}, {"> 00202F60600003000000", "< 00306060600000000000"});
  EXPECT_TRUE(result());
  now += 100ms;
  download(kLateMode, {4}, {"> 00202F60600004000000", "< 00306060600000000000"});
  EXPECT_EQ(result().error().code, Errc::timeout);
}

TEST_F(CoeClientTest, WhatWasHeardIsPartOfTheMessageAboutSilence) {
  upload(kLateStatus,
         {"> 00204041600000000000", "< 00308000000000000206", "+ 500ms", "> 00208041600000000405"});
  expect_failure(
      Errc::protocol,
      "node 2, object 0x6041:0: no answer within 500 ms; it aborted with 0x06020000 and named object "
      "0x0000:0");
}

void hear_one(CoeClient& client, SlowServer& server, TimePoint now) {
  Bytes answer{0x00, 0x30};
  const auto& bytes = server.coming.front().second;
  answer.insert(answer.end(), bytes.begin(), bytes.end());
  server.coming.pop_front();
  client.on_message(answer, now);
}

Result<Bytes> run(CoeClient& client, SlowServer& server, TimePoint& now) {
  for (;;) {
    while (const auto sent = client.take_message()) {
      canopen::SdoBytes request{};
      std::copy_n(sent->begin() + 2, 8, request.begin());
      server.on_request(request, now);
    }
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

RC_GTEST_PROP(CoeClient, NoMixtureOfLateAndDoubledAnswersTellsAnUntruth, ()) {
  ethercat::CoeClient client(2, 500ms, 26);
  SlowServer server;
  TimePoint now{1s};
  server.next = [] {
    return SlowServer::Answering{*rc::gen::weightedElement<Duration>({{6, 1ms}, {2, 700ms}, {1, 1700ms}}),
                                 *rc::gen::weightedElement<int>({{6, 1}, {2, 2}, {1, 0}}),
                                 *rc::gen::weightedElement<bool>({{7, false}, {1, true}})};
  };
  server.set(kLateMode, 0, now);
  for (int step = *rc::gen::inRange(2, 12); step > 0; --step) {
    while (!server.coming.empty() && server.coming.front().first <= now)
      hear_one(client, server, server.coming.front().first);
    const auto value = *rc::gen::arbitrary<std::uint8_t>();
    if (*rc::gen::inRange(0, 4) == 0) server.set(kLateMode, value, now);
    const auto begun = now;
    if (*rc::gen::arbitrary<bool>()) {
      client.start_upload(kLateMode, now);
      const auto end = run(client, server, now);
      if (end) RC_ASSERT(server.had(kLateMode, end->front(), begun));
      continue;
    }
    const auto& all = server.values[kLateMode];
    const auto before = static_cast<std::ptrdiff_t>(all.size());
    client.start_download(kLateMode, {value}, now);
    const auto end = run(client, server, now);
    const auto writes_it = [&](const auto& write) { return write.value == value; };
    if (end) RC_ASSERT(std::any_of(all.begin(), all.end(), writes_it));
    if (!end && end.error().code == Errc::sdo_abort)
      RC_ASSERT(std::none_of(all.begin() + before, all.end(), writes_it));
  }
}

}  // namespace
}  // namespace servoctl::ethercat
