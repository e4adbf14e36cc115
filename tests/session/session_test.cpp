#include "session/session.hpp"
#include "session/can_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "session/scan.hpp"
#include "session/write.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

/// A bus whose drives the test can reach, with a count of what was sent.
class Bench final : public can::Bus {
 public:
  explicit Bench(std::string_view spec) : cell(sim::build_cell(spec, kFolders, bus.now()).value()) {
    for (const auto& drive : cell.drives) bus.attach(*drive);
  }
  TimePoint now() const override { return bus.now(); }
  Result<void> send(const can::Frame& frame) override {
    sent.push_back(can::to_string(frame));
    if (broken || sent.size() > breaks_after) return fail(Errc::bus, "can0 went down");
    return bus.send(frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override { return bus.receive(deadline); }
  TimePoint next_event() const override { return bus.next_event(); }

  std::vector<std::string> sent;
  bool broken = false;
  std::size_t breaks_after = std::numeric_limits<std::size_t>::max();  ///< So many frames.
  sim::SimBus bus{sim::SimBus::Clock::virtual_time};
  sim::Cell cell;
};

class SessionTest : public testing::Test {
 protected:
  void open(std::string_view spec) {
    auto owned = std::make_unique<Bench>(spec);
    bench = owned.get();
    session = std::make_unique<Session>(std::move(owned), "test", Options{});
    ASSERT_TRUE(session->listen());
    (void)session->take_events();
    bench->sent.clear();
  }
  Bench* bench = nullptr;
  std::unique_ptr<Session> session;
};

std::vector<std::uint8_t> all_nodes() {
  std::vector<std::uint8_t> out;
  for (int node = 1; node <= 127; ++node) out.push_back(static_cast<std::uint8_t>(node));
  return out;
}

TEST_F(SessionTest, ScansAllNodesInOneTimeout) {
  open("gsd600@3,gsd600@17,gsd600@127");
  const auto before = session->now();
  const auto found = scan(*session, all_nodes());
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 3U);
  EXPECT_EQ((*found)[0].node, 3);
  EXPECT_EQ((*found)[2].node, 127);
  EXPECT_EQ((*found)[1].device_type, 0x0002'0192U);
  EXPECT_EQ((*found)[1].software_version, "1.00");
  EXPECT_LT(session->now() - before, 530ms) << "and 20 ms for a second node of the same number";
}

/// Frames without an end, each of them as late as reading it takes.
class FloodedBus final : public can::Bus {
 public:
  TimePoint now() const override { return now_; }
  Result<void> send(const can::Frame&) override { return {}; }
  Result<std::optional<can::Frame>> receive(TimePoint) override {
    now_ += 50us;
    EXPECT_LT(++taken, 100'000) << "it never ends";
    if (taken == 100'000) return fail(Errc::bus, "enough");
    return std::optional(can::parse_frame("123#01").value());
  }
  int taken = 0;

 private:
  TimePoint now_{1s};
};

TEST(SessionListens, ATenthOfASecondWhereFramesComeFasterThanTheyAreRead) {
  auto owned = std::make_unique<FloodedBus>();
  auto* const bus = owned.get();
  Session session(std::move(owned), "test", Options{});
  const auto begin = session.now();
  EXPECT_TRUE(session.listen());
  EXPECT_LE(session.now() - begin, 110ms);
  EXPECT_GE(bus->taken, 1'000) << "and not less than what is there in that time";
}

TEST_F(SessionTest, TellsAScanOfALostBusFromAnEmptyOne) {
  open("gsd600@3");
  bench->broken = true;
  const auto found = scan(*session, all_nodes());
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Errc::bus);
}

TEST_F(SessionTest, DoesNotTakeAWriteForDoneWhoseAbortCannotBeSent) {
  open("gsd600@1");
  bench->cell.drives[0]->wire_faults().silent = true;
  bench->breaks_after = 1;
  const auto done = session->download(1, {0x6060, 0}, Bytes{3});
  ASSERT_FALSE(done) << "it was not answered, and then the bus was lost";
  EXPECT_EQ(done.error().code, Errc::bus);
  EXPECT_EQ(bench->sent.size(), 2U);
  EXPECT_EQ(bench->sent.back(), "601#8060600000000405");
}

TEST_F(SessionTest, AsksDifferentNodesAtTheSameTime) {
  open("gsd600@1,gsd600@2,gsd600@3,gsd600@4?delay=100ms");
  std::vector<SdoRequest> requests;
  for (std::uint8_t node = 1; node <= 4; ++node) requests.push_back({node, {0x6041, 0}, {}});
  const auto before = session->now();
  for (const auto& answer : session->transfer(requests)) EXPECT_TRUE(answer);
  EXPECT_LT(session->now() - before, 110ms);
}

TEST_F(SessionTest, RepeatsAReadWithoutAnswer) {
  open("gsd600@1");
  bench->cell.drives[0]->wire_faults().drop_answers = 1;
  EXPECT_TRUE(session->upload(1, {0x6041, 0}));
  EXPECT_EQ(bench->sent, (std::vector<std::string>{"601#4041600000000000", "601#8041600000000405",
                                                   "601#4041600000000000"}));
}

TEST_F(SessionTest, CostsOneTimeoutAndItsRetriesForADeadNodeHoweverMuchIsAsked) {
  open("gsd600@1");
  std::vector<SdoRequest> requests(20, SdoRequest{9, {0x6041, 0}, {}});
  const auto before = session->now();
  const auto answers = session->transfer(requests);
  for (const auto& answer : answers) EXPECT_EQ(answer.error().code, Errc::timeout);
  EXPECT_EQ(session->now() - before, 1000ms);
}

TEST_F(SessionTest, NeverSendsAWriteTwiceAndFindsThatItArrived) {
  open("gsd600@1");
  bench->cell.drives[0]->wire_faults().drop_answers = 1;
  const SdoRequest request{1, {0x6060, 0}, Bytes{3}};
  const auto written = write_all(*session, std::span(&request, 1), false);
  ASSERT_TRUE(written.front()) << written.front().error().message.text();
  EXPECT_TRUE(written.front()->answer_lost);
  EXPECT_EQ(std::count(bench->sent.begin(), bench->sent.end(), "601#2F60600003000000"), 1);
}

TEST_F(SessionTest, SaysThatItIsUnknownWhetherAWriteArrivedAtANodeThatFellSilent) {
  open("gsd600@1");
  const SdoRequest request{1, {0x6060, 0}, Bytes{3}};
  auto& drive = *bench->cell.drives[0];
  drive.wire_faults().silent = true;
  session->options().timeout = 100ms;
  const auto answers = session->transfer(std::span(&request, 1));
  EXPECT_EQ(answers.front().error().code, Errc::timeout);
  const auto gone = write_all(*session, std::span(&request, 1), false);
  ASSERT_FALSE(gone.front());
  EXPECT_EQ(gone.front().error().code, Errc::timeout);
  EXPECT_NE(gone.front().error().message.text().find("cannot be read back"), std::string::npos);
  EXPECT_EQ(state_text(gone.front(), request.object), "not known");
  EXPECT_EQ(std::count(bench->sent.begin(), bench->sent.end(), "601#2F60600003000000"), 2);
}

/// Loses requests on their way, which the simulated drive cannot.
class Lossy final : public can::Bus {
 public:
  explicit Lossy(std::unique_ptr<Bench> inner) : inner_(std::move(inner)) {}
  TimePoint now() const override { return inner_->now(); }
  Result<void> send(const can::Frame& frame) override {
    if (can::to_string(frame) == lost) return {};
    return inner_->send(frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override { return inner_->receive(deadline); }
  std::string lost;

 private:
  std::unique_ptr<Bench> inner_;
};

TEST_F(SessionTest, SaysSoWhenAWriteWithoutAnswerHadNoEffect) {
  auto lossy = std::make_unique<Lossy>(std::make_unique<Bench>("gsd600@1"));
  lossy->lost = "601#2F60600003000000";
  Session lossy_session(std::move(lossy), "test", Options{});
  const SdoRequest request{1, {0x6060, 0}, Bytes{3}};
  const auto written = write_all(lossy_session, std::span(&request, 1), false);
  ASSERT_FALSE(written.front());
  EXPECT_EQ(written.front().error().code, Errc::negative);
  EXPECT_EQ(state_text(written.front(), request.object), "holds another value");
  EXPECT_EQ(
      written.front().error().message.text(),
      "node 1, object 0x6060:0: the write was sent, but no answer came, and it had no effect: the object "
      "holds 01");
}

TEST_F(SessionTest, SendsNoFurtherWriteAfterARefusedOne) {
  open("gsd600@1");
  const std::vector<SdoRequest> requests{
      {1, {0x6060, 0}, Bytes{3}}, {1, {0x5FFF, 0}, Bytes{1}}, {1, {0x6060, 0}, Bytes{1}}};
  const auto answers = session->transfer(requests);
  EXPECT_TRUE(answers[0]);
  EXPECT_EQ(answers[1].error().code, Errc::sdo_abort);
  EXPECT_EQ(answers[1].error().abort_code, 0x0602'0000U);
  ASSERT_FALSE(answers[2]);
  EXPECT_NE(answers[2].error().message.text().find("skipped because"), std::string::npos);
  EXPECT_EQ(session->upload(1, {0x6061, 0}).value(), Bytes{3});
}

TEST_F(SessionTest, ReadsWhatItWroteAndComparesIt) {
  open("gsd600@1");
  const SdoRequest request{1, {0x2001, 0x0F}, Bytes{0xC2, 0x01}};
  const auto written = write_all(*session, std::span(&request, 1), true);
  ASSERT_TRUE(written.front()) << written.front().error().message.text();
  EXPECT_EQ(written.front()->read_back, (Bytes{0xC2, 0x01}));
}

TEST_F(SessionTest, TakesTheAnswerOfTheNodeItAskedThoughFramesComeTwice) {
  open("gsd600@1");
  bench->cell.drives[0]->wire_faults().duplicate_answers = 3;
  const std::vector<SdoRequest> requests{{1, {0x6041, 0}, {}}, {1, {0x6061, 0}, {}}, {1, {0x1000, 0}, {}}};
  const auto answers = session->transfer(requests);
  EXPECT_EQ(*answers[0], (Bytes{0x70, 0x02}));
  EXPECT_EQ(*answers[1], Bytes{0x01});
  EXPECT_EQ(*answers[2], (Bytes{0x92, 0x01, 0x02, 0x00}));
}

TEST_F(SessionTest, MissesNothingThatNodesTellWhileACommandWaits) {
  open("gsd600@1,gsd600@2");
  bench->cell.drives[0]->raise_fault_at({0xFF00, {}}, session->now() + 50ms);
  (void)session->upload(9, {0x6041, 0});
  const auto events = session->take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].node, 1);
  EXPECT_EQ(std::get<canopen::Emergency>(events[0].what).code, 0xFF00);
}

TEST_F(SessionTest, EndsEveryWaitWhenItIsCancelled) {
  open("gsd600@1");
  bool cancel = false;
  session->options().cancelled = [&] { return cancel; };
  EXPECT_TRUE(session->upload(1, {0x6041, 0}));
  cancel = true;
  EXPECT_EQ(session->upload(1, {0x6041, 0}).error().code, Errc::interrupted);
  EXPECT_EQ(session->wait([] { return false; }, session->now() + 1h).error().code, Errc::interrupted);
}

TEST_F(SessionTest, GuessesTheFamilyAndSaysThatItIsAGuess) {
  open("gsd600@1");
  const auto found = scan(*session, std::vector<std::uint8_t>{1});
  ASSERT_TRUE(found);
  const auto guesses = guess_families(found->front(), drive::find_families(kFolders));
  ASSERT_EQ(guesses.size(), 2U);
  EXPECT_EQ(guesses[0].family, "gsd600");
  EXPECT_FALSE(guesses[0].certain);
  EXPECT_TRUE(guesses[1].generic) << "the family of the profile goes last";
  auto other = found->front();
  other.device_type = 0x0003'0000;
  EXPECT_TRUE(guess_families(other, drive::find_families(kFolders)).empty());
}

TEST_F(SessionTest, ProducesSyncInEveryWaitWithItsCounterAndItsPeriod) {
  open("gsd600@1");
  const auto begin = session->now();
  session->can()->produce_sync({.period = 2ms, .last_counter = 3});
  EXPECT_EQ(session->next_event(), begin);
  // The waits are of any kind: for time, for an answer, for a key.
  ASSERT_TRUE(session->wait([] { return false; }, begin + 5ms));
  ASSERT_TRUE(session->upload(1, {0x1000, 0}));
  while (session->now() < begin + 9ms)
    ASSERT_TRUE(session->step(std::min(session->next_event(), begin + 9ms)));
  std::vector<std::string> syncs;
  for (const auto& frame : bench->sent)
    if (frame.starts_with("080#")) syncs.push_back(frame);
  EXPECT_EQ(syncs, (std::vector<std::string>{"080#01", "080#02", "080#03", "080#01", "080#02"}));
  const auto& rhythm = session->can()->sync()->rhythm;
  EXPECT_EQ(rhythm.count(), 5U);
  EXPECT_NEAR(rhythm.intervals().mean(), 2, 0.07);
  EXPECT_EQ(session->can()->sync()->producer.missed(), 0U);
  session->can()->stop_sync();
  ASSERT_TRUE(session->wait([] { return false; }, session->now() + 50ms));
  EXPECT_EQ(session->can()->sync(), nullptr);
  EXPECT_EQ(std::count(bench->sent.begin(), bench->sent.end(), "080#03"), 1);
}

}  // namespace
}  // namespace servoctl::session
