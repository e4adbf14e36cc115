#include "session/bitrate_search.hpp"

#include <gtest/gtest.h>

#include <cerrno>

#include "tests/session/fake_link.hpp"

namespace servoctl::session {
namespace {

using Verdict = Heard::Verdict;

can::Frame heartbeat() {
  can::Frame out;
  out.id = 0x701;
  out.size = 1;
  out.data[0] = 5;
  return out;
}

/// A stuff error, as a controller reports it that listens at a wrong bitrate (linux/can/error.h: CAN_ERR_PROT
/// | CAN_ERR_BUSERROR, data[2] CAN_ERR_PROT_STUFF).
can::Frame stuff_error() {
  can::Frame out;
  out.error = true;
  out.id = 0x088;
  out.size = 8;
  out.data[2] = 0x04;
  return out;
}

SearchOptions at(std::vector<std::uint32_t> bitrates) { return {.bitrates = std::move(bitrates)}; }

TEST(BitrateSearch, EndsWithTheBitrateAtWhichFramesComeAndPutsTheInterfaceBack) {
  FakeLink link(controller(true, 1'000'000));
  link.on_wire[500'000] = std::vector<can::Frame>(30, stuff_error());
  link.on_wire[250'000] = std::vector<can::Frame>(30, heartbeat());
  const auto search = search_bitrate(link, at({500'000, 250'000, 125'000}));
  ASSERT_TRUE(search.has_value());
  EXPECT_EQ(search->bitrate, 250'000U);
  ASSERT_EQ(search->heard.size(), 2U);
  EXPECT_EQ(search->heard[0].verdict, Verdict::errors);
  EXPECT_EQ(search->heard[1].verdict, Verdict::fits);
  EXPECT_EQ(link.listened, (std::vector<std::uint32_t>{500'000, 250'000}));
  EXPECT_TRUE(link.listened_only) << "what listens must not acknowledge";
  EXPECT_TRUE(link.now.up);
  EXPECT_FALSE(link.now.listen_only);
  EXPECT_EQ(link.now.bitrate, 1'000'000U);
}

TEST(BitrateSearch, OfASilentBusTriesAllAndFindsNone) {
  FakeLink link(controller(false, std::nullopt));
  const auto search = search_bitrate(link, at({500'000, 250'000}));
  ASSERT_TRUE(search.has_value());
  EXPECT_FALSE(search->bitrate.has_value());
  EXPECT_EQ(search->heard[1].verdict, Verdict::silent);
  EXPECT_FALSE(link.now.up);
  EXPECT_FALSE(link.now.listen_only);
  EXPECT_EQ(link.clock, TimePoint{} + std::chrono::seconds(4));
}

TEST(BitrateSearch, HearsOneFrameAmongErrorsOfTheWiringForNoBitrate) {
  FakeLink link(controller(true));
  auto frames = std::vector<can::Frame>(5, stuff_error());
  frames.push_back(heartbeat());
  link.on_wire[500'000] = frames;
  const auto search = search_bitrate(link, at({500'000}));
  ASSERT_TRUE(search.has_value());
  EXPECT_EQ(search->heard[0].verdict, Verdict::errors);
}

TEST(BitrateSearch, GoesOnBehindABitrateThatTheControllerCannotHave) {
  FakeLink link(controller(true));
  link.refuses = [](const can::LinkChange& change) { return change.bitrate == 800'000U ? EDOM : 0; };
  link.on_wire[250'000] = {heartbeat(), heartbeat(), heartbeat()};
  const auto search = search_bitrate(link, at({800'000, 250'000}));
  ASSERT_TRUE(search.has_value());
  EXPECT_EQ(search->heard[0].verdict, Verdict::unreachable);
  EXPECT_EQ(search->bitrate, 250'000U);
}

TEST(BitrateSearch, RefusesAnInterfaceThatCannotOnlyListen) {
  FakeLink deaf(controller(true));
  deaf.now.can_listen_only = false;
  EXPECT_EQ(search_bitrate(deaf, at({500'000})).error().message.text(),
            "the driver of can0 cannot listen without acknowledging");
  EXPECT_TRUE(deaf.done.empty());
  FakeLink old(controller(true));  // An older kernel does not tell, and refuses.
  old.refuses = [](const can::LinkChange& change) { return change.listen_only == true ? EOPNOTSUPP : 0; };
  EXPECT_EQ(search_bitrate(old, at({500'000, 250'000})).error().message.text(),
            "the driver of can0 cannot listen without acknowledging");
  EXPECT_TRUE(old.listened.empty());
  EXPECT_TRUE(old.now.up);
  FakeLink none(controller(true));
  none.now.kind = "vcan";
  EXPECT_EQ(search_bitrate(none, at({500'000})).error().message.text(), "can0 (vcan) has no bitrate to set");
}

TEST(BitrateSearch, PutsTheInterfaceBackWhenItIsCancelled) {
  FakeLink link(controller(true));
  auto options = at({250'000, 125'000});
  int left = 50;
  options.cancelled = [&] { return --left < 0; };
  EXPECT_EQ(search_bitrate(link, options).error().code, Errc::interrupted);
  EXPECT_TRUE(link.now.up);
  EXPECT_EQ(link.now.bitrate, 500'000U);
  EXPECT_FALSE(link.now.listen_only);
}

TEST(BitrateSearch, SaysWhenTheInterfaceCouldNotBePutBack) {
  FakeLink link(controller(true, 1'000'000));
  link.refuses = [](const can::LinkChange& change) { return change.bitrate == 1'000'000U ? EIO : 0; };
  const auto search = search_bitrate(link, at({250'000}));
  ASSERT_FALSE(search.has_value());
  EXPECT_NE(search.error().message.text().find("could not be put back"), std::string::npos)
      << search.error().message.text();
}

}  // namespace
}  // namespace servoctl::session
