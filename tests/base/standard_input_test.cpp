#include "base/standard_input.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string_view>
#include <vector>

namespace servoctl {
namespace {

/// A pipe that is written to piece by piece.
class StandardInputTest : public testing::Test {
 protected:
  StandardInputTest() { EXPECT_EQ(::pipe(ends_), 0); }
  ~StandardInputTest() override {
    ::close(ends_[0]);
    if (ends_[1] >= 0) ::close(ends_[1]);
  }

  void send(std::string_view text) {
    EXPECT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void end() {
    ::close(ends_[1]);
    ends_[1] = -1;
  }
  StandardInput open() const { return StandardInput(ends_[0]); }

 private:
  int ends_[2] = {-1, -1};
};

TEST_F(StandardInputTest, GivesALineWhenItIsThereInWhole) {
  auto input = open();
  std::string line = "as before";
  send("scan\n\nread 0x");
  EXPECT_FALSE(input.take_line(line));
  EXPECT_TRUE(input.read_more());
  EXPECT_TRUE(input.take_line(line));
  EXPECT_EQ(line, "scan");
  EXPECT_TRUE(input.take_line(line));
  EXPECT_EQ(line, "");
  EXPECT_FALSE(input.take_line(line));
  send("6041\n");
  EXPECT_TRUE(input.read_more());
  EXPECT_TRUE(input.take_line(line));
  EXPECT_EQ(line, "read 0x6041");
}

TEST_F(StandardInputTest, TheLastLineNeedsNoEnd) {
  auto input = open();
  std::string line;
  send("scan\nstatus");
  end();
  EXPECT_TRUE(input.read_more());
  EXPECT_FALSE(input.read_more());
  EXPECT_TRUE(input.take_line(line));
  EXPECT_TRUE(input.take_line(line));
  EXPECT_EQ(line, "status");
  EXPECT_FALSE(input.take_line(line));
}

TEST_F(StandardInputTest, GivesTheRestToItsEndOrUntilItIsTooMuch) {
  auto input = open();
  std::string line;
  send("first\nsecond\nthird");
  EXPECT_TRUE(input.read_more());
  EXPECT_TRUE(input.take_line(line));
  EXPECT_EQ(input.take_rest(3), "second\nthird");
  end();
  EXPECT_EQ(input.take_rest(), "");
}

TEST(StandardInput, WhatCannotBeReadHasEnded) {
  StandardInput input(-1);
  std::string line;
  EXPECT_FALSE(input.read_more());
  EXPECT_FALSE(input.take_line(line));
  EXPECT_EQ(input.take_rest(), "");
}

}  // namespace
}  // namespace servoctl
