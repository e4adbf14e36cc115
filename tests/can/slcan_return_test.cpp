// An adapter that goes, and one that comes back at its port.
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>

#include "can/slcan.hpp"
#include "tests/can/late_opening.hpp"
#include "tests/can/slcan_fixture.hpp"

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A name of a port that stays while the adapter behind it changes, as udev makes one.
class Plug {
 public:
  explicit Plug(const char* name) : link_(std::filesystem::path(testing::TempDir()) / name) {}
  ~Plug() { pull(); }
  Plug(const Plug&) = delete;
  Plug& operator=(const Plug&) = delete;

  void into(const ScriptedAdapter& adapter) {
    pull();
    std::filesystem::create_symlink(adapter.path(), link_);
  }
  void pull() { std::filesystem::remove(link_); }
  std::string place() const { return link_.string() + "@1M"; }

 private:
  std::filesystem::path link_;
};

TEST(Slcan, AnAdapterThatIsPulledInTheMiddleOfALineIsToldAtOnce) {
  ScriptedAdapter adapter;
  const auto bus = open_at(adapter);
  adapter.say("t5811AA\rt58184300");
  EXPECT_EQ(next_frame(*bus), slcan_frame("581#AA"));
  adapter.unplug();
  const auto begin = bus->now();
  const auto lost = bus->receive(bus->now() + seconds(5));
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, Errc::bus);
  EXPECT_NE(lost.error().message.text().find(adapter.path() + " is gone"), std::string::npos);
  EXPECT_LT(bus->now() - begin, seconds(1));
  EXPECT_FALSE(bus->send(slcan_frame("601#00")));
  EXPECT_EQ(bus->poll_fd(), -1) << "a port that is held keeps its number";
}

TEST(Slcan, AnOpeningThatTakesLongerThanARecoveryGoesOnWithTheNextOne) {
  ScriptedAdapter before;
  Plug plug("slcan-opens-late");
  plug.into(before);
  auto bus = open_slcan(plug.place());
  ASSERT_TRUE(bus);
  before.unplug();
  EXPECT_FALSE((*bus)->receive((*bus)->now() + seconds(1)));
  std::atomic<int> opened = 0;
  ScriptedAdapter after([&](const std::string& command) {
    if (command == "C") nap(milliseconds(200));
    if (command == "O") ++opened;
    return ScriptedAdapter::good(command);
  });
  plug.into(after);
  EXPECT_GT(recoveries_until_open(**bus, slcan_frame("601#00")), 3);
  EXPECT_EQ(opened, 1);
  EXPECT_TRUE((*bus)->send(slcan_frame("601#00")));
}

TEST(Slcan, AnAdapterThatComesBackIsOpenedAnew) {
  ScriptedAdapter before;
  Plug plug("slcan-comes-back");
  plug.into(before);
  auto bus = open_slcan(plug.place());
  ASSERT_TRUE(bus);
  before.unplug();
  plug.pull();
  EXPECT_FALSE((*bus)->receive((*bus)->now() + seconds(1)));
  EXPECT_FALSE((*bus)->recover((*bus)->now() + milliseconds(50)));
  ScriptedAdapter after;
  plug.into(after);
  EXPECT_TRUE((*bus)->recover((*bus)->now() + seconds(1)));
  EXPECT_TRUE(after.hears("S8"));
  EXPECT_TRUE((*bus)->send(slcan_frame("601#00")));
  after.say("t5811AA\r");
  EXPECT_EQ(next_frame(**bus), slcan_frame("581#AA"));
}

}  // namespace
}  // namespace servoctl::can
