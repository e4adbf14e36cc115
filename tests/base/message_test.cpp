#include "base/message.hpp"

#include <gtest/gtest.h>
#include <algorithm>

namespace servoctl {
namespace {

std::string in_brackets(std::string_view command) { return "<" + std::string(command) + ">"; }

TEST(MessageTest, HasItsArgumentsAtTheirPlacesAndFormats) {
  EXPECT_EQ(message("{} of {:04X}h in {:.1f} s", 3, 0x60u, 1.25).text(), "3 of 0060h in 1.2 s");
  EXPECT_EQ(message("{1} before {0}", "b", "a").text(), "a before b");
  EXPECT_EQ(message("{{{}}}", 1).text(), "{1}");
  EXPECT_EQ(message("{:>{}}|", 7, 3).text(), "  7|");
  EXPECT_EQ(Message("a brace { without arguments }").text(), "a brace { without arguments }");
}

TEST(MessageTest, WhatIsPutInIsNeverReadAsAFormat) {
  for (const char* text : {"{}", "{0} and {1}", "{:x}", "}", "`read 1`", "node 3", "%s", ""}) {
    EXPECT_EQ(message("file {}", as_it_is(text)).text(), std::string("file ") + text);
    EXPECT_EQ(Message(std::string(text)).text(), text);
    EXPECT_EQ(message("{}: {}", message("at {}", as_it_is(text)), 1).text(),
              std::string("at ") + text + ": 1");
  }
}

TEST(MessageTest, NodesAreNumbersUntilTheyHaveNames) {
  Nodes nodes{{3, 4}};
  EXPECT_EQ(message("nodes {}: no answer", nodes).text(), "nodes 3, 4: no answer");
  nodes.names = {"feeder", ""};
  EXPECT_EQ(message("nodes {}: no answer", nodes).text(), "feeder, 4: no answer");
  EXPECT_EQ(message("`read 1 -n {}`", nodes).text(), "`read 1 -n feeder, 4`");
  nodes.names = {"", "lift"};
  EXPECT_EQ(message("nodes {}", nodes).text(), "nodes 3, lift");
}

/// A command is what the program proposes; a file may have backticks in its name.
TEST(MessageTest, OnlyCommandsOfTheTextHaveAPlace) {
  EXPECT_EQ(message("`read {}` or `scan`", 1).text(in_brackets), "`<read 1>` or `<scan>`");
  EXPECT_EQ(message("cannot open {}", as_it_is("a`b`c")).text(in_brackets), "cannot open a`b`c");
  EXPECT_EQ(message("{}; {}", Message("`scan` shows them"), as_it_is("`x`")).text(in_brackets),
            "`<scan>` shows them; `x`");
  EXPECT_EQ(Message("a single ` stays").text(in_brackets), "a single ` stays");
}

TEST(MessageTest, BetweenChineseAndChineseIsNoBlank) {
  EXPECT_EQ(message("是 {} 上", Message("在总线")).text(), "是在总线上");
  EXPECT_EQ(message("是 {} 上", "main").text(), "是 main 上");
  EXPECT_EQ(message("是 {}{} 上", as_it_is("文 "), as_it_is(" 件")).text(), "是文  件上");
  EXPECT_EQ(message("at {} on", as_it_is("文")).text(), "at 文 on");
}

/// What an exception says ends with it.
TEST(MessageTest, WhatAPointerPointsToIsCopied) {
  std::string said = "no such device";
  const Message whole(said.c_str());
  const auto part = message("can0: {}", said.c_str());
  std::fill(said.begin(), said.end(), '?');
  EXPECT_EQ(whole.text(), "no such device");
  EXPECT_EQ(part.text(), "can0: no such device");
}

/// A literal that has the letters of a name does not name it.
TEST(MessageTest, NamesWhatStandsAtItsPlaces) {
  Nodes nodes{{3}};
  nodes.names = {"feeder"};
  EXPECT_TRUE(message("{}; {}", 1, message("node {}", nodes)).names("feeder"));
  EXPECT_TRUE(message("{} differs", as_it_is("Pn0214 Speed loop gain")).names("Pn0214"));
  EXPECT_FALSE(message("the feeder of node {}", 3).names("feeder"));
}

/// What a person typed says nothing of what kind of message it is.
TEST(MessageTest, SaysWhatItsTextsSay) {
  EXPECT_TRUE(message("{}; {}", 1, Message("--turn gives it")).says("--turn "));
  EXPECT_FALSE(message("'{}' is not an option", as_it_is("--turn x")).says("--turn "));
}

TEST(MessageTest, TwoAreOneBehindTheOther) {
  auto both = Message("first");
  both += message("; {}", 2);
  EXPECT_EQ(both.text(), "first; 2");
  EXPECT_EQ((Message() + Message("only")).text(), "only");
  EXPECT_TRUE((Message() + Message(std::string())).empty());
}

}  // namespace
}  // namespace servoctl
