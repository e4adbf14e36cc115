#include "cli/terminal/progress.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "recording_console.hpp"
#include "session/session.hpp"
#include "session/stretch.hpp"
#include "sim/sim_bus.hpp"

namespace servoctl::cli {
namespace {

using namespace std::chrono_literals;

TEST(Progress, SpeaksAfterAWhileTenTimesASecondAndWipesItsLine) {
  RecordingConsole console;
  Progress progress(console);
  const TimePoint begin{5s};
  progress.update(0, 1000, begin);
  progress.update(100, 1000, begin + 299ms);
  EXPECT_TRUE(console.progress.empty());
  progress.update(250, 1000, begin + 500ms);
  progress.update(300, 1000, begin + 599ms);
  progress.update(1000, 1000, begin + 1000ms);
  progress.end();
  EXPECT_EQ(console.progress,
            (std::vector<std::string>{"[#######.......................]  25% of 1000 bytes, 0.5 kB/s",
                                      "[##############################] 100% of 1000 bytes, 1.0 kB/s", ""}));
}

TEST(Progress, KnowsNoShareOfAnUnknownWhole) {
  RecordingConsole console;
  Progress progress(console);
  progress.update(0, {}, TimePoint{5s});
  progress.update(2000, {}, TimePoint{6s});
  EXPECT_EQ(console.progress, std::vector<std::string>{"2000 bytes, 2.0 kB/s"});
}

TEST(Progress, CountsThePartsOfALongList) {
  RecordingConsole console;
  Progress progress(console);
  progress.update_list(1, 400, TimePoint{5s});
  progress.update_list(100, 400, TimePoint{6s});
  EXPECT_EQ(console.progress,
            std::vector<std::string>{"[#######.......................]  25% (100/400), 3 s left"});
}

TEST(Progress, SaysHowLongItWillGoOn) {
  RecordingConsole console;
  Progress progress(console);
  progress.update(0, 1000, TimePoint{5s});
  progress.update(100, 1000, TimePoint{15s});
  progress.update(1000, 1000, TimePoint{16s});
  console.set_chinese(true);
  progress.update_list(100, 400, TimePoint{17s});
  EXPECT_EQ(console.progress, (std::vector<std::string>{
                                  "[###...........................]  10% of 1000 bytes, 0.0 kB/s, 2 min left",
                                  "[##############################] 100% of 1000 bytes, 0.1 kB/s",
                                  "[#######.......................]  25% (100/400)，还需 36 s"}));
}

TEST(Progress, SaysInWordsWhereAWaitIsThatHasNoKnownEnd) {
  RecordingConsole console;
  Progress progress(console);
  progress.update_line("found: 0", TimePoint{5s});
  progress.update_line("found: 1", TimePoint{6s});
  progress.update_line("found: 2", TimePoint{6s + 50ms});
  progress.end();
  EXPECT_EQ(console.progress, (std::vector<std::string>{"found: 1", ""}));
}

/// A wait on a bus whose clock only waits move on.
struct Waiting {
  Waiting() : progress(console) { progress.begin(); }
  void pass(Duration time, const session::Stretch* stretch = nullptr) {
    (void)session.wait([] { return false; }, session.now() + time);
    progress.update_wait(stretch, session.now());
  }
  RecordingConsole console;
  Progress progress;
  session::Session session{std::make_unique<sim::SimBus>(sim::SimBus::Clock::virtual_time), "sim:", {}};
};

TEST(Progress, SaysHowLongSomethingTakesOfWhichNobodyKnowsTheEnd) {
  Waiting at;
  at.pass(0ms);
  at.pass(200ms);
  EXPECT_TRUE(at.console.progress.empty());
  at.pass(300ms);
  at.pass(11s);
  at.pass(60s);
  at.console.set_chinese(true);
  at.pass(1s);
  EXPECT_EQ(at.console.progress, (std::vector<std::string>{"0.5 s so far", "11 s so far", "1 min 11 s so far",
                                                           "已用 1 min 12 s"}));
}

TEST(Progress, ShowsAWaitOfKnownLengthAsABarAndOneThatMayEndBeforeWithItsLatestEnd) {
  Waiting at;
  const session::Stretch known(at.session, at.session.now() + 4s);
  const session::Stretch latest(at.session, at.session.now() + 5min, session::Stretch::End::at_latest);
  at.pass(0ms, &known);
  at.pass(1s, &known);
  at.pass(1s, &latest);
  EXPECT_EQ(at.console.progress, (std::vector<std::string>{"[#######.......................]  25%, 3 s left",
                                                           "2.0 s so far, 5 min at most"}));
}

TEST(Progress, ShowsHowMuchOfAWayIsDone) {
  Waiting at;
  session::Stretch way(at.session, kNever);
  at.pass(0ms, &way);
  way.set_share(0.5);
  at.pass(2s, &way);
  way.set_share(1.2);
  at.pass(1s, &way);
  EXPECT_EQ(at.console.progress, (std::vector<std::string>{"[###############...............]  50%, 2 s left",
                                                           "[##############################] 100%"}));
}

TEST(Progress, WaitsInSilenceBesideWhatTellsMoreAndOutsideOfALine) {
  Waiting at;
  at.pass(0ms);
  at.pass(1s);
  at.progress.note_output();
  at.pass(500ms);
  at.pass(400ms);
  EXPECT_EQ(at.console.progress.size(), 1U) << "the line shows something of its own";
  at.pass(1s);
  EXPECT_EQ(at.console.progress.size(), 2U);
  at.progress.update_list(50, 400, at.session.now() + 200ms);
  at.pass(500ms);
  EXPECT_EQ(at.console.progress.size(), 3U) << "a list tells more than a wait";
  at.progress.end();
  at.progress.leave();
  at.pass(5s);
  at.pass(5s);
  EXPECT_EQ(at.console.progress.size(), 4U) << "the last one wiped it";
}

TEST(Stretch, IsKnownToItsSessionAsLongAsItLives) {
  Waiting at;
  const session::Stretch* told = nullptr;
  int times = 0;
  at.session.options().waiting = [&](const session::Stretch* stretch, TimePoint) {
    told = stretch;
    ++times;
  };
  at.pass(1s);
  EXPECT_EQ(told, nullptr);
  EXPECT_GE(times, 3);
  EXPECT_LE(times, 10);
  {
    const session::Stretch outer(at.session, kNever);
    auto inner = std::make_unique<session::Stretch>(at.session, kNever);
    at.pass(1s);
    EXPECT_EQ(told, inner.get());
    inner.reset();
    at.pass(1s);
    EXPECT_EQ(told, &outer);
  }
  at.pass(1s);
  EXPECT_EQ(told, nullptr);
}

TEST(Progress, TellsOfAWaitOnlyWhereWhatToldMoreIsOld) {
  for (const auto& tell : std::vector<std::function<void(Progress&, TimePoint)>>{
           [](Progress&progress, TimePoint now) { progress.update(500, 1000, now); },
           [](Progress&progress, TimePoint now) { progress.update_list(50, 100, now); },
           [](Progress&progress, TimePoint now) { progress.update_line("node 1", now); }}) {
    Waiting at;
    at.pass(0ms);
    at.pass(400ms);
    tell(at.progress, at.session.now() + 200ms);
    at.pass(500ms);
    EXPECT_EQ(at.console.progress.size(), 2U) << at.console.progress.back();
    at.pass(1s);
    EXPECT_EQ(at.console.progress.back(), "1.9 s so far");
  }
}

TEST(Progress, LeavesTheTurnToAListThoughEachAnswerComesBehindAWait) {
  Waiting at;
  at.pass(0ms);
  for (std::size_t done = 1; done < 40; ++done) {
    at.pass(100ms);
    at.progress.update_list(done, 40, at.session.now() + 20ms);
  }
  EXPECT_EQ(at.console.progress.back(), "[#############################.]  97% (39/40), 1 s left");
}

TEST(Progress, CountsAWaitInAWaitFromItsOwnBegin) {
  Waiting at;
  at.pass(0ms);
  at.pass(10s);
  const session::Stretch latest(at.session, at.session.now() + 100s, session::Stretch::End::at_latest);
  at.pass(2s, &latest);
  const session::Stretch known(at.session, at.session.now() + 8s);
  at.pass(2s, &known);
  EXPECT_EQ(at.console.progress,
            (std::vector<std::string>{"10 s so far", "2.0 s so far, 100 s at most",
                                      "[#######.......................]  25%, 6 s left"}));
}

TEST(Progress, ShowsAWaitWhoseEndIsKnownBesideWhatTheLineShows) {
  Waiting at;
  const session::Stretch known(at.session, at.session.now() + 4s);
  const session::Stretch open(at.session, kNever);
  at.pass(0ms, &known);
  at.progress.note_output();
  at.pass(1s, &known);
  EXPECT_EQ(at.console.progress.size(), 1U);
  at.progress.note_output();
  at.pass(500ms, &open);
  EXPECT_EQ(at.console.progress.size(), 1U) << "how long it goes on is not known";
}

TEST(Progress, BeginsAnewWithEachLineThoughItsBusHasAnotherClock) {
  RecordingConsole console;
  Progress progress(console);
  progress.begin();
  progress.update(0, 1000, TimePoint{100s});
  progress.update(500, 1000, TimePoint{101s});
  progress.end();
  progress.update(0, 1000, TimePoint{101s});
  progress.update(500, 1000, TimePoint{101s + 200ms});
  progress.end();
  EXPECT_EQ(console.progress.size(), 2U) << "the second one was quick";
  progress.update(500, 1000, TimePoint{101s});
  progress.update(500, 1000, TimePoint{102s});
  progress.end();
  console.progress.clear();
  progress.update_wait(nullptr, TimePoint{2s});
  progress.update_wait(nullptr, TimePoint{3s});
  EXPECT_EQ(console.progress, std::vector<std::string>{"1.0 s so far"});
}

TEST(Progress, ShowsAShareOfWhatBeganBeforeItWasTold) {
  RecordingConsole console;
  Progress progress(console);
  progress.update_share(0.5, TimePoint{5s}, TimePoint{9s});
  EXPECT_EQ(console.progress, std::vector<std::string>{"[###############...............]  50%, 4 s left"});
}

TEST(Progress, SaysNothingOfAListOfNothing) {
  RecordingConsole console;
  Progress progress(console);
  progress.update_list(0, 0, TimePoint{5s});
  progress.update_list(0, 0, TimePoint{6s});
  EXPECT_TRUE(console.progress.empty());
}

TEST(Progress, SpeaksTheLanguageOfTheConsoleInWordsToo) {
  RecordingConsole console;
  console.set_chinese(true);
  Progress progress(console);
  progress.update_line("node 3", TimePoint{5s});
  progress.update_line("node 3", TimePoint{6s});
  EXPECT_EQ(console.progress, std::vector<std::string>{"节点 3"});
}

TEST(Stretch, LeavesTheOthersToTheirSessionInWhicheverOrderTheyEnd) {
  Waiting at;
  auto first = std::make_unique<session::Stretch>(at.session, kNever);
  const session::Stretch second(at.session, kNever);
  first.reset();
  EXPECT_EQ(at.session.stretches(), std::vector<const session::Stretch*>{&second});
}

TEST(Stretch, KnowsAShareBetweenNothingAndAllWhereItsEndIsCertain) {
  Waiting at;
  const auto now = at.session.now();
  const session::Stretch known(at.session, now + 4s);
  EXPECT_EQ(known.share(now - 1s), 0.0);
  EXPECT_EQ(known.share(now + 1s), 0.25);
  EXPECT_EQ(known.share(now + 5s), 1.0);
  EXPECT_EQ(session::Stretch(at.session, now).share(now), std::nullopt) << "it has no length";
  EXPECT_EQ(session::Stretch(at.session, kNever).share(now), std::nullopt);
  session::Stretch latest(at.session, now + 4s, session::Stretch::End::at_latest);
  EXPECT_EQ(latest.share(now + 1s), std::nullopt);
  latest.set_share(-0.5);
  EXPECT_EQ(latest.share(now), 0.0);
  latest.set_share(1.5);
  EXPECT_EQ(latest.share(now), 1.0);
}

TEST(Progress, IsSilentAboutWhatIsQuick) {
  RecordingConsole console;
  Progress progress(console);
  progress.update(10, 20, TimePoint{5s});
  progress.end();
  EXPECT_TRUE(console.progress.empty());
}

}  // namespace
}  // namespace servoctl::cli
