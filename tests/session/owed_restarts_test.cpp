// Values that were written while nobody knew what the drive is.
#include "session/owed_restarts.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <span>

#include "session/session.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

namespace fs = std::filesystem;

constexpr ObjectAddress kWaits{0x2003, 2};  ///< Pn0601 of a gsd600.
constexpr ObjectAddress kActsAtOnce{0x2000, 7};

class UnjudgedWrites : public testing::Test {
 protected:
  UnjudgedWrites() {
    Options options;
    options.exchanged = [this](const Exchange& exchange) { owed.on_exchange(exchange, starts); };
    session = std::make_unique<Session>(
        sim::open_sim("gsd600@1", folders, sim::SimBus::Clock::virtual_time).value(), "sim:gsd600@1",
        options);
    profile = drive::load_profile("gsd600", folders).value();
    for (const auto object : {kWaits, kActsAtOnce}) EXPECT_TRUE(session->download(1, object, {0, 0}));
  }

  const fs::path folders[1] = {fs::path(source_dir()) / "eds"};
  OwedRestarts owed;
  Starts starts{1, 1};
  std::unique_ptr<Session> session;
  drive::Profile profile;
};

TEST_F(UnjudgedWrites, AreReportedOnceAndJudgedWhenTheFamilyIsNamed) {
  EXPECT_EQ(owed.take_unjudged(1, starts), (std::vector{kWaits, kActsAtOnce}));
  EXPECT_TRUE(owed.take_unjudged(1, starts).empty());
  ASSERT_TRUE(session->download(1, kWaits, {1, 0}));
  EXPECT_EQ(owed.take_unjudged(1, starts), std::vector{kWaits}) << "it was written anew";
  EXPECT_TRUE(owed.values(1, starts).empty());
  owed.learn(1, profile, false, starts);
  ASSERT_EQ(owed.values(1, starts).size(), 1U);
  EXPECT_EQ(owed.values(1, starts).front().object, kWaits);
}

TEST_F(UnjudgedWrites, AreNoOnesOfTheGenericFamily) {
  const auto generic = drive::load_profile("cia402", folders).value();
  owed.learn(1, generic, false, starts);
  EXPECT_EQ(owed.take_unjudged(1, starts).size(), 2U);
  owed.learn(1, profile, false, starts);
  EXPECT_EQ(owed.values(1, starts).size(), 1U);
}

/// A table that somebody has made of a drive: what it says of an object holds.
TEST_F(UnjudgedWrites, AreJudgedByAFileWithoutAFamilyWhereItSaysWhenTheyTakeEffect) {
  auto table = drive::load_profile("cia402", folders).value();
  for (const auto& parameter : profile.parameters)
    if (parameter.object == kWaits) table.parameters.push_back(parameter);
  table.build_index();
  owed.learn(1, table, false, starts);
  EXPECT_EQ(owed.take_unjudged(1, starts), std::vector{kActsAtOnce});
  ASSERT_EQ(owed.values(1, starts).size(), 1U);
  EXPECT_EQ(owed.values(1, starts).front().object, kWaits);
  ASSERT_TRUE(session->download(1, kWaits, {1, 0}));
  EXPECT_TRUE(owed.take_unjudged(1, starts).empty());
}

TEST_F(UnjudgedWrites, AreOverBehindTheRestartOfTheFamily) {
  ++starts.restarts;
  EXPECT_EQ(owed.take_unjudged(1, starts).size(), 2U) << "a reset may be no restart of this drive";
  owed.learn(1, profile, false, starts);
  EXPECT_TRUE(owed.values(1, starts).empty());
}

TEST_F(UnjudgedWrites, AreOverBehindPowerOff) {
  ++starts.restarts;
  ++starts.power_ups;
  EXPECT_TRUE(owed.take_unjudged(1, starts).empty());
}

}  // namespace
}  // namespace servoctl::session
