// Jobs that are written as if each were alone on a session run side by side on it.
#include "session/interleave.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <new>
#include <stdexcept>

#include "session/option_scope.hpp"
#include "session/restore.hpp"
#include "session/snapshot.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

const std::vector<std::filesystem::path> kInterleaveFolders{std::filesystem::path(source_dir()) / "eds"};
constexpr ObjectAddress kAcceleration{0x6083, 0};

/// What may happen to a bus on which jobs run side by side.
struct Mishap {
  int lost_after = -1;  ///< Frames sent.
  bool throws = false;  ///< And not in the way of a Result.
};

class MishapBus final : public can::Bus {
 public:
  MishapBus(std::unique_ptr<can::Bus> bus, const Mishap& mishap) : bus_(std::move(bus)), mishap_(mishap) {}
  TimePoint now() const override { return bus_->now(); }
  TimePoint next_event() const override { return bus_->next_event(); }
  Result<void> send(const can::Frame& frame) override {
    if (is_lost()) return fail(Errc::bus, "the bus is lost");
    ++sent_;
    return bus_->send(frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (!is_lost()) return bus_->receive(deadline);
    if (mishap_.throws) throw std::runtime_error("the bus is gone");
    return fail(Errc::bus, "the bus is lost");
  }

 private:
  bool is_lost() const { return mishap_.lost_after >= 0 && sent_ >= mishap_.lost_after; }
  std::unique_ptr<can::Bus> bus_;
  Mishap mishap_;
  int sent_ = 0;
};

std::unique_ptr<Session> cabinet_of(std::string_view spec, const Mishap& mishap = {}) {
  auto bus = sim::open_sim(spec, kInterleaveFolders, sim::SimBus::Clock::virtual_time);
  EXPECT_TRUE(bus) << bus.error().message.text();
  auto out =
      std::make_unique<Session>(std::make_unique<MishapBus>(std::move(*bus), mishap), "sim:", Options{});
  (void)out->listen();
  return out;
}

std::string eight_drives() {
  std::string out;
  for (int node = 1; node <= 8; ++node) out += fmt::format("{}gsd600@{}", node == 1 ? "" : ",", node);
  return out + "?delay=2ms";
}

const drive::Profile& interleaved_profile() {
  static const auto profile = drive::load_profile("gsd600", kInterleaveFolders).value();
  return profile;
}

/// The settings of one node, read as if it were the only one.
Result<Snapshot> settings_of_one(Session& session, std::uint8_t node) {
  return take_snapshots(session, interleaved_profile(), std::span(&node, 1), {}).front();
}

/// The time that this takes on the clock of the session.
template <class What>
Duration lasts(Session& session, const What& what) {
  const auto begin = session.now();
  what();
  return session.now() - begin;
}

TEST(Interleave, SnapshotsOfEightDrivesTakeAsLongAsOfOne) {
  const auto session = cabinet_of(eight_drives());
  const auto alone = lasts(*session, [&] { EXPECT_TRUE(settings_of_one(*session, 8)); });
  std::vector<Result<Snapshot>> read(8, Result<Snapshot>(fail(Errc::negative, "not read")));
  std::vector<Job> jobs;
  for (std::uint8_t node = 1; node <= 8; ++node)
    jobs.emplace_back([&, node] { read[node - 1U] = settings_of_one(*session, node); });
  const auto together = lasts(*session, [&] { run_side_by_side(*session, jobs); });
  for (std::uint8_t node = 1; node <= 8; ++node) {
    ASSERT_TRUE(read[node - 1U]) << read[node - 1U].error().message.text();
    EXPECT_EQ(read[node - 1U]->identity.node, node);
    EXPECT_GT(read[node - 1U]->entries.size(), 100U);
  }
  EXPECT_GT(alone, 100ms);
  EXPECT_LE(together, alone * 11 / 10);
}

TEST(Interleave, RestoresOfEightDrivesTakeAsLongAsTheLongest) {
  const auto session = cabinet_of(eight_drives());
  const auto restore_of = [&](std::uint8_t node, std::uint32_t values) {
    Values present;
    Values wanted;
    for (std::uint8_t i = 0; i < values; ++i) {
      const ObjectAddress object{static_cast<std::uint16_t>(i < 1 ? 0x6083 : 0x6084), 0};
      present[object] = *session->upload(node, object);
      wanted[object] = store_le(1000U + node * 10U + i, 4);
    }
    return restore(*session, &interleaved_profile(), node, present, wanted, {});
  };
  Duration longest{};
  for (std::uint8_t node = 1; node <= 8; ++node)
    longest = std::max(longest, lasts(*session, [&] { (void)restore_of(node, 1U + node % 2U); }));
  const auto second = cabinet_of(eight_drives());
  std::vector<Job> jobs;
  for (std::uint8_t node = 1; node <= 8; ++node)
    jobs.emplace_back([&, node] {
      const auto outcome = restore_of(node, 1U + node % 2U);
      EXPECT_FALSE(outcome.failure) << outcome.failure->message.text();
      EXPECT_EQ(outcome.writes, 1U + node % 2U);
    });
  for (std::uint8_t node = 1; node <= 8; ++node)
    EXPECT_TRUE(session->download(node, kAcceleration, store_le(7, 4)));
  for (std::uint8_t node = 1; node <= 8; ++node)
    EXPECT_TRUE(session->download(node, {0x6084, 0}, store_le(7, 4)));
  EXPECT_LE(lasts(*session, [&] { run_side_by_side(*session, jobs); }), longest * 11 / 10);
  for (std::uint8_t node = 1; node <= 8; ++node)
    EXPECT_EQ(*session->upload(node, kAcceleration), store_le(1000U + node * 10U, 4));
}

TEST(Interleave, OptionsOfOneJobDoNotReachAnother) {
  const auto session = cabinet_of("gsd600@1,gsd600@2?delay=2ms");
  session->options().timeout = 321ms;
  session->options().progress = [](auto, auto, auto) {};
  bool hurried = false;
  const Job jobs[] = {[&] {
                        const Hurry hurry(*session, 10ms, 0);
                        const Deaf deaf(*session);
                        hurried = true;
                        EXPECT_TRUE(session->upload(1, kAcceleration));
                        EXPECT_EQ(session->options().timeout, 10ms);
                        (void)session->wait([] { return false; }, session->now() + 1s);
                        hurried = false;
                      },
                      [&] {
                        EXPECT_TRUE(hurried);
                        EXPECT_EQ(session->options().timeout, 321ms);
                        EXPECT_FALSE(session->options().progress);
                        EXPECT_TRUE(session->upload(2, kAcceleration));
                        EXPECT_TRUE(hurried);
                        EXPECT_EQ(session->options().timeout, 321ms);
                        EXPECT_EQ(session->options().retries, Options{}.retries);
                        session->options().timeout = 5ms;
                      }};
  run_side_by_side(*session, jobs);
  EXPECT_EQ(session->options().timeout, 321ms);
  EXPECT_TRUE(session->options().progress);
}

TEST(Interleave, CancelledEndsAllThatHearIt) {
  const auto session = cabinet_of(eight_drives());
  bool cancelled = false;
  session->options().cancelled = [&] { return cancelled; };
  std::size_t interrupted = 0;
  bool deaf_goes_on = false;
  std::vector<Job> jobs{[&] {
                          const Deaf deaf(*session);
                          (void)session->wait([] { return false; }, session->now() + 5s);
                          deaf_goes_on = session->upload(1, kAcceleration).has_value();
                        },
                        [&] {
                          (void)session->wait([] { return false; }, session->now() + 1s);
                          cancelled = true;
                        },
                        [&] {
                          // Nothing concerns it but Ctrl-C.
                          const auto begin = session->now();
                          const auto waited = session->wait([] { return false; }, begin + 100s);
                          ASSERT_FALSE(waited);
                          EXPECT_EQ(waited.error().code, Errc::interrupted);
                          EXPECT_LT(session->now() - begin, 2s);
                          ++interrupted;
                        }};
  for (std::uint8_t node = 3; node <= 8; ++node)
    jobs.emplace_back([&, node] {
      for (;;) {
        const auto answer = session->upload(node, kAcceleration);
        if (answer) continue;
        EXPECT_EQ(answer.error().code, Errc::interrupted);
        ++interrupted;
        return;
      }
    });
  const auto took = lasts(*session, [&] { run_side_by_side(*session, jobs); });
  EXPECT_EQ(interrupted, 7U);
  EXPECT_TRUE(deaf_goes_on);
  EXPECT_LT(took, 6s);
  EXPECT_TRUE(session->options().cancelled);
}

TEST(Interleave, ALostBusEndsAll) {
  for (const bool throws : {false, true}) {
    SCOPED_TRACE(throws);
    const auto session = cabinet_of(eight_drives(), {.lost_after = 100, .throws = throws});
    std::size_t lost = 0;
    std::vector<Job> jobs;
    for (std::uint8_t node = 1; node <= 8; ++node)
      jobs.emplace_back([&, node] {
        const auto read = settings_of_one(*session, node);
        ASSERT_FALSE(read);
        EXPECT_EQ(read.error().code, Errc::bus);
        ++lost;
      });
    if (throws)
      EXPECT_THROW(run_side_by_side(*session, jobs), std::runtime_error);
    else
      run_side_by_side(*session, jobs);
    EXPECT_EQ(lost, 8U);
  }
}

TEST(Interleave, AnArrivalWakesOnlyWhomItConcerns) {
  const auto session = cabinet_of("gsd600@1,gsd600@2?delay=2ms");
  std::size_t woken = 0;
  const Job jobs[] = {[&] {
                        for (int i = 0; i < 50; ++i) EXPECT_TRUE(session->upload(1, kAcceleration));
                      },
                      [&] {
                        const auto end = session->now() + 50ms;
                        while (session->now() < end) {
                          (void)session->step(end, [] { return false; });
                          ++woken;
                        }
                      }};
  run_side_by_side(*session, jobs);
  EXPECT_EQ(woken, 1U);
}

TEST(Interleave, WhatOneTakesInInPassingStillReachesTheOther) {
  const auto session = cabinet_of("gsd600@1,gsd600@2");
  Duration took{};
  const Job jobs[] = {
      [&] { took = lasts(*session, [&] { EXPECT_TRUE(session->upload(1, kAcceleration)); }); },
      [&] {
        // The answer to the first is there already.
        EXPECT_TRUE(session->listen());
        (void)session->wait([] { return false; }, session->now() + 400ms);
      }};
  run_side_by_side(*session, jobs);
  EXPECT_LT(took, 1ms);
}

TEST(Interleave, WhatAJobThrowsIsThrownWhenAllHaveEnded) {
  const auto session = cabinet_of("gsd600@1,gsd600@2?delay=2ms");
  bool ended = false;
  const Job jobs[] = {[&] { throw std::out_of_range("no"); },
                      [&] {
                        EXPECT_TRUE(session->upload(2, kAcceleration));
                        ended = true;
                      }};
  EXPECT_THROW(run_side_by_side(*session, jobs), std::out_of_range);
  EXPECT_TRUE(ended);
  EXPECT_TRUE(session->upload(1, kAcceleration));
}

/// Each goes its way out: none stays where it waits.
TEST(Interleave, WhatIsThrownBesideTheJobsEndsThemAll) {
  const auto session = cabinet_of("gsd600@1,gsd600@2,gsd600@3?delay=2ms");
  session->options().list_progress = [](std::size_t, std::size_t, TimePoint) { throw std::bad_alloc(); };
  std::size_t lost = 0;
  const std::function<bool()> throws = [] { return throw std::out_of_range("no"), false; };
  const Job jobs[] = {[&] { lost += !session->upload(1, kAcceleration); },
                      [&] { lost += !session->step(session->now() + 10s, throws); },
                      [&] {
                        const auto waited = session->wait([] { return false; }, session->now() + 10s);
                        lost += !waited && waited.error().code == Errc::bus;
                      }};
  EXPECT_ANY_THROW(run_side_by_side(*session, jobs));
  EXPECT_EQ(lost, 3U);
  session->options().list_progress = {};
  EXPECT_TRUE(session->upload(1, kAcceleration));
}

TEST(Interleave, JobsOfAJobRunOneAfterTheOther) {
  const auto session = cabinet_of("gsd600@1,gsd600@2?delay=2ms");
  std::string order;
  const Job inner[] = {[&] {
                         EXPECT_TRUE(session->upload(1, kAcceleration));
                         order += "1";
                       },
                       [&] { order += "2"; }};
  const Job jobs[] = {[&] { run_side_by_side(*session, inner); },
                      [&] { EXPECT_TRUE(session->upload(2, kAcceleration)); }};
  run_side_by_side(*session, jobs);
  EXPECT_EQ(order, "12");
}

TEST(Interleave, TellsHowManyJobsHaveEnded) {
  const auto session = cabinet_of(eight_drives());
  std::string told;
  session->options().list_progress = [&](std::size_t done, std::size_t total, TimePoint) {
    told += fmt::format("{}/{} ", done, total);
  };
  std::vector<Job> jobs;
  for (std::uint8_t node = 1; node <= 4; ++node)
    jobs.emplace_back([&, node] { EXPECT_TRUE(settings_of_one(*session, node)); });
  run_side_by_side(*session, jobs);
  EXPECT_EQ(told, "1/4 2/4 3/4 4/4 ");
}

}  // namespace
}  // namespace servoctl::session
