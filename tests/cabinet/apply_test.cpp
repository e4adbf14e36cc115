// A cabinet of drives of five families: apply makes it as its file says.
#include "cabinet/apply.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "drive/drive_settings.hpp"
#include "fleet_checks.hpp"
#include "session/write.hpp"
#include "settings/comparison.hpp"

namespace servoctl::cabinet {
namespace {

TEST(CabinetApply, MakesFortyAxesAsTheFileSaysAndThenDoesNothing) {
  Fleet fleet(40, 3);
  EXPECT_GT(fleet.different(), 80U);
  const auto answer = fleet.apply();
  ASSERT_TRUE(answer) << answer.error().message.text();
  expect_no_errors(fleet);
  EXPECT_EQ(Fleet::results_of(*answer), std::vector<std::string>(40, "applied"));
  EXPECT_EQ(fleet.different(), 0U);
  const auto again = fleet.apply();
  ASSERT_TRUE(again);
  EXPECT_EQ(Fleet::results_of(*again), std::vector<std::string>(40, "nothing to do"));
  fleet.power_cycle();
  expect_kept(fleet);
  for (const auto& file : fs::directory_iterator(fleet.folder()))
    EXPECT_EQ(file.path().extension(), ".json") << file.path() << ": no journal, no lock";
}

TEST(CabinetApply, MakesPdosAndHeartbeatsOfOperationalDrives) {
  Fleet fleet(10);
  fleet.give_pdos_and_heartbeats();
  fleet.start_all();
  const auto looks = fleet.look();
  bool state = false;
  for (const auto& look : looks) {
    ASSERT_TRUE(look.plan) << look.axis->family << ": " << look.plan.error().message.text();
    EXPECT_GT(look.plan->different, 0U);
    for (const auto& need : look.plan->needs) state = state || need.kind == AxisNeed::Kind::state;
  }
  EXPECT_TRUE(state) << "no family changes PDOs outside Operational only";
  const auto answer = fleet.apply();
  ASSERT_TRUE(answer) << answer.error().message.text();
  expect_no_errors(fleet);
  EXPECT_EQ(Fleet::results_of(*answer), std::vector<std::string>(10, "applied"));
  EXPECT_EQ(fleet.different(), 0U);
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    const auto heartbeat = fleet.cabinet.axes[i].heartbeat;
    EXPECT_TRUE(!heartbeat || load_le(fleet.drive(i).value({0x1017, 0})) == 500);
    EXPECT_EQ(fleet.drive(i).nmt_state(), canopen::NmtState::operational) << fleet.cabinet.axes[i].family;
  }
  fleet.power_cycle();
  expect_kept(fleet);
}

/// Does something at the moment at which somebody agrees.
class Meddler final : public show::Audience {
 public:
  explicit Meddler(std::function<void()> what) : what_(std::move(what)) {}
  Result<void> confirm(std::string_view question) override {
    questions.emplace_back(question);
    what_();
    return {};
  }
  std::vector<std::string> questions;

 private:
  std::function<void()> what_;
};

TEST(CabinetApply, LeavesADriveAloneThatHasChangedSinceItWasLookedAt) {
  Fleet fleet(5);
  Meddler meddler([&] { EXPECT_TRUE(change_at_the_panel(fleet, 2, {0x6065, 0})); });
  fleet.cabinet.axes[2] = [&] {
    auto axis = fleet.cabinet.axes[2];
    axis.parameters.push_back({"0x6065", "65536", {99, 1}});
    return axis;
  }();
  fleet.desk.audience = &meddler;
  const auto answer = fleet.apply();
  ASSERT_TRUE(answer) << answer.error().message.text();
  EXPECT_EQ(meddler.questions.size(), 1U);
  EXPECT_EQ(Fleet::results_of(*answer),
            (std::vector<std::string>{"applied", "applied", "not changed", "applied", "applied"}));
  ASSERT_EQ(fleet.desk.errors.size(), 1U);
  EXPECT_EQ(fleet.desk.errors[0].code, Errc::refused);
  EXPECT_NE(fleet.desk.errors[0].message.text().find("axis3"), std::string::npos);
  EXPECT_NE(fleet.desk.errors[0].message.text().find("changed since the plan was made"), std::string::npos);
}

TEST(CabinetApply, WritesNothingUnlessSomebodyAgrees) {
  Fleet fleet(5);
  show::Unwilling unwilling;
  fleet.desk.audience = &unwilling;
  const auto before = fleet.different();
  const auto answer = fleet.apply();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Errc::refused);
  EXPECT_EQ(fleet.different(), before);
  fleet.desk.audience = nullptr;
  fleet.desk.dry_run = true;
  const auto frames = fleet.apply();
  ASSERT_TRUE(frames) << frames.error().message.text();
  EXPECT_NE(report::to_text(*frames).find("601#"), std::string::npos) << report::to_text(*frames);
  EXPECT_EQ(fleet.different(), before);
  EXPECT_TRUE(fs::is_empty(fleet.folder()));
}

TEST(CabinetApply, LeavesAnEnergisedDriveAloneAndThePlanSaysSo) {
  Fleet fleet(5);
  auto& session = fleet.session(2);
  const auto node = fleet.cabinet.axes[2].node;
  for (const std::uint64_t word : {6U, 7U, 15U}) {
    ASSERT_TRUE(session.download(node, {0x6040, 0}, store_le(word, 2)));
    (void)session.wait([] { return false; }, session.now() + 1s);
  }
  const auto look = fleet.look()[2];
  ASSERT_TRUE(look.plan) << look.plan.error().message.text();
  ASSERT_FALSE(look.plan->needs.empty());
  EXPECT_EQ(look.plan->needs.back().kind, AxisNeed::Kind::power);
  ApplyOptions all;
  all.all_or_nothing = true;
  const auto none = fleet.apply(all);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Errc::refused);
  const auto answer = fleet.apply();
  ASSERT_TRUE(answer);
  EXPECT_EQ(Fleet::results_of(*answer),
            (std::vector<std::string>{"applied", "applied", "not changed", "applied", "applied"}));
}

TEST(CabinetApply, OnlyAPartIsWrittenWhereAPartIsNamed) {
  Fleet fleet(1);
  fleet.cabinet.axes[0].heartbeat = 700ms;
  fleet.cabinet.axes[0].heartbeat_at = fleet.cabinet.axes[0].at;
  const auto all = fleet.different();
  const auto part = fleet.different({.only = "communication", .unlisted = false});
  EXPECT_EQ(part, 1U);
  ApplyOptions options;
  options.choice.only = "communication";
  ASSERT_TRUE(fleet.apply(options));
  EXPECT_EQ(load_le(fleet.drive(0).value({0x1017, 0})), 700U);
  EXPECT_EQ(fleet.different(), all - 1);
}

TEST(CabinetApply, RefusesTwoAxesThatWouldSendWithOneCanId) {
  Fleet fleet(5);
  for (const std::size_t i : {1U, 4U}) {
    auto& axis = fleet.cabinet.axes[i];
    drive::PdoRecipe recipe;
    recipe.pdo = "TPDO2";
    recipe.cob_id = "0x2F0";
    recipe.valid = true;
    axis.pdos.recipes = {recipe};
    axis.pdos.at = axis.at;
  }
  const auto looks = fleet.look();
  EXPECT_NE(looks[1].plan.has_value(), looks[4].plan.has_value()) << "one of them";
  for (const auto& look : looks)
    EXPECT_TRUE(look.plan || look.plan.error().message.text().find("0x2F0") != std::string::npos);
}

TEST(CabinetApply, OfFortyAxesTakesAsLongAsOfTheSlowest) {
  Duration slowest{};
  {
    Fleet fleet(5, 1, 3ms);
    for (std::size_t i = 0; i < fleet.size(); ++i) {
      auto& session = fleet.session(i);
      const auto begin = session.now();
      ASSERT_TRUE(fleet.apply({fleet.stations()[i]}, {}));
      slowest = std::max(slowest, session.now() - begin);
    }
  }
  // Twenty on one bus: with forty the frames themselves take longer than the drives.
  Fleet fleet(40, 2, 3ms);
  const TimePoint begin[] = {fleet.session(0).now(), fleet.session(1).now()};
  const auto answer = fleet.apply();
  const auto together = std::max(fleet.session(0).now() - begin[0], fleet.session(1).now() - begin[1]);
  ASSERT_TRUE(answer);
  expect_no_errors(fleet);
  RecordProperty("alone_us", static_cast<int>(slowest.count()));
  RecordProperty("together_us", static_cast<int>(together.count()));
  EXPECT_GT(slowest, 100ms);
  EXPECT_LE(together, slowest * 12 / 10);
}

}  // namespace
}  // namespace servoctl::cabinet
