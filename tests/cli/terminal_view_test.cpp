#include "cli/terminal/terminal_view.hpp"

#include <gtest/gtest.h>
#include <chrono>
#include <deque>
#include <string>
#include <utility>

namespace servoctl::cli {
namespace {

using namespace std::chrono_literals;
using show::LiveView;

/// Keys that a test presses.
class PressedKeys final : public command::Keys {
 public:
  explicit PressedKeys(std::deque<std::pair<Key, char>>& keys) : keys_(&keys) {}
  Key take() override {
    if (keys_->empty()) return Key::none;
    const auto [key, character] = keys_->front();
    keys_->pop_front();
    character_ = character;
    return key;
  }
  char character() const override { return character_; }

 private:
  std::deque<std::pair<Key, char>>* keys_;
  char character_ = '\0';
};

class TerminalViewTest : public testing::Test {
 protected:
  TerminalView open(bool alternate = false) {
    return TerminalView({.columns = {{.title = "object"}, {.title = "value"}}, .alternate_screen = alternate},
                        {.write = [this](std::string_view text) { written.emplace_back(text); },
                         .size = [this] { return size; },
                         .closed = [this] { ++closed; }},
                        std::make_unique<PressedKeys>(keys));
  }
  void press(char character) { keys.emplace_back(command::Keys::Key::other, character); }
  static bool has(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

  std::deque<std::pair<command::Keys::Key, char>> keys;
  std::vector<std::string> written;
  Screen::Size size{80, 24};
  int closed = 0;
  TimePoint start{1s};
};

TEST_F(TerminalViewTest, DrawsTenTimesASecondAtMost) {
  auto view = open();
  for (auto time = 0ms; time < 1000ms; time += 1ms) {
    view.set("position", {"Position", std::to_string(time.count())}, 1.0);
    view.refresh(start + time);
  }
  EXPECT_EQ(written.size(), 10U);
}

TEST_F(TerminalViewTest, StandsWhereItStood) {
  auto view = open();
  view.set("position", {"Position", "12 inc"}, 12);
  view.refresh(start);
  EXPECT_EQ(written.back().substr(0, 1), "\r");
  EXPECT_FALSE(has(written.back(), "\033[3A"));
  view.refresh(start + 100ms);
  EXPECT_EQ(written.back().substr(0, 5), "\r\033[3A") << "heading, row and keys";
  EXPECT_TRUE(has(written.back(), "12 inc"));
  EXPECT_EQ(written.back().substr(written.back().size() - 3), "\033[J") << "nothing of a longer one stays";
}

TEST_F(TerminalViewTest, OtherTextStandsAboveIt) {
  auto view = open();
  view.set("position", {"Position", "12 inc"}, 12);
  view.refresh(start);
  view.step_aside();
  EXPECT_EQ(written.back(), "\r\033[3A\033[J");
  view.step_aside();
  EXPECT_EQ(written.size(), 2U);
  view.refresh(start + 100ms);
  EXPECT_FALSE(has(written.back(), "\033[3A"));
  EXPECT_EQ(written.back().substr(0, 7), "\robject");
}

TEST_F(TerminalViewTest, AScreenOfAnotherSizeBeginsAtItsTop) {
  auto view = open();
  view.set("position", {"Position", "12 inc"}, 12);
  view.refresh(start);
  size = {200, 50};
  view.refresh(start + 100ms);
  EXPECT_EQ(written.back().substr(0, 2), "\r\n");
  EXPECT_TRUE(has(written.back(), "\033[Hobject"));
  view.refresh(start + 200ms);
  EXPECT_EQ(written.back().substr(0, 5), "\r\033[3A");
}

TEST_F(TerminalViewTest, SpacePausesSSortsAndQEnds) {
  auto view = open();
  view.set("b", {"B", "1"}, {});
  view.set("a", {"A", "2"}, {});
  view.refresh(start);
  press(' ');
  press('s');
  view.set("a", {"A", "later"}, {});
  view.refresh(start + 100ms);
  EXPECT_TRUE(has(written.back(), "PAUSED"));
  EXPECT_TRUE(has(written.back(), "object*"));
  EXPECT_FALSE(has(written.back(), "later"));
  EXPECT_FALSE(view.is_over());
  press('q');
  view.refresh(start + 110ms);
  EXPECT_TRUE(view.is_over()) << "without waiting for the next picture";
}

TEST_F(TerminalViewTest, EndsWithItsTerminal) {
  auto view = open();
  keys.emplace_back(command::Keys::Key::lost, '\0');
  view.refresh(start);
  EXPECT_TRUE(view.is_over());
}

TEST_F(TerminalViewTest, LeavesItsLastStateOnTheScreen) {
  {
    auto view = open();
    view.set("position", {"Position", "12 inc"}, 12);
    view.refresh(start);
    view.set("position", {"Position", "13 inc"}, 13);
  }
  EXPECT_TRUE(has(written.back(), "13 inc"));
  EXPECT_EQ(closed, 1);
}

TEST_F(TerminalViewTest, TheOtherScreenComesBack) {
  {
    auto view = open(true);
    EXPECT_EQ(written.front(), "\033[?1049h\033[H");
    view.set("position", {"Position", "12 inc"}, 12);
    view.refresh(start);
    view.refresh(start + 100ms);
    EXPECT_EQ(written.back().substr(0, 3), "\033[H");
  }
  EXPECT_EQ(written.back(), "\033[?1049l");
}

TEST_F(TerminalViewTest, AScreenWithoutRoomShowsNothing) {
  auto view = open();
  size = {1, 2};
  view.refresh(start);
  EXPECT_TRUE(written.empty());
}

}  // namespace
}  // namespace servoctl::cli
