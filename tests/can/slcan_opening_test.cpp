#include "can/slcan_opening.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;
using OpeningState = SlcanOpening::State;

/// An adapter that answers to each command what a function says, so long after it; in virtual time.
class SlcanOpen : public testing::Test {
 protected:
  using Firmware = std::function<std::string(const std::string& command)>;

  OpeningState open(const Firmware& firmware, milliseconds delay = milliseconds(1),
                    SlcanOpening::Mode mode = SlcanOpening::Mode::normal) {
    TimePoint now{milliseconds(1000)};
    const auto begin = now;
    SlcanOpening opening('6', mode, now);
    SlcanReader reader;
    std::vector<std::pair<TimePoint, std::string>> answers;
    for (int steps = 0; steps < 1000 && !opening.is_done(); ++steps) {
      if (const auto text = opening.take_text(); !text.empty()) {
        sent_ += text;
        answers.emplace_back(std::max(now, answers.empty() ? now : answers.back().first) + delay,
                             firmware(text));
      }
      if (!answers.empty() && answers.front().first <= opening.deadline()) {
        now = std::max(now, answers.front().first);
        reader.put(answers.front().second);
        answers.erase(answers.begin());
        while (const auto line = reader.take()) opening.on_line(*line, now);
      } else {
        now = opening.deadline();
      }
      opening.on_time(now);
    }
    owed_ = answers.size();
    took_ = std::chrono::duration_cast<milliseconds>(now - begin);
    version_ = opening.version();
    acknowledges_ = opening.acknowledges();
    heard_something_ = opening.heard_something();
    return opening.state();
  }

  std::string sent_;
  std::string version_;
  milliseconds took_{};
  std::size_t owed_ = 0;  ///< Answers that were still under way in the end.
  bool acknowledges_ = false;
  bool heard_something_ = false;
};

std::string lawicel(const std::string& command) {
  if (command == "C\r") return "\a";  // It is closed already.
  return command == "V\r" ? "V1013\r" : "\r";
}

TEST_F(SlcanOpen, ClosesSetsTheBitrateAndOpens) {
  EXPECT_EQ(open(lawicel), OpeningState::open);
  EXPECT_EQ(sent_, "C\rV\rS6\rO\r");
  EXPECT_EQ(version_, "V1013");
  EXPECT_TRUE(acknowledges_);
  EXPECT_LT(took_, milliseconds(10));
}

TEST_F(SlcanOpen, OpensToListenOnly) {
  EXPECT_EQ(open(lawicel, milliseconds(1), SlcanOpening::Mode::listen_only), OpeningState::open);
  EXPECT_EQ(sent_, "C\rV\rS6\rL\r");
}

TEST_F(SlcanOpen, ALateAdapterIsWaitedForLongerEachRound) {
  for (const int delay : {250, 400}) {
    sent_.clear();
    EXPECT_EQ(open(lawicel, milliseconds(delay)), OpeningState::open) << delay;
    EXPECT_TRUE(acknowledges_) << delay;
  }
}

TEST_F(SlcanOpen, AnswersThatComeInTheNextRoundAreNotTakenForThoseToItsWords) {
  for (int delay = 50; delay <= 1150; delay += 50) {
    sent_.clear();
    EXPECT_EQ(open(lawicel, milliseconds(delay)), OpeningState::open) << delay;
    EXPECT_EQ(owed_, 0U) << delay << " ms: " << sent_;
    EXPECT_EQ(sent_.substr(sent_.size() - 5), "S6\rO\r") << delay;
    EXPECT_EQ(std::count(sent_.begin(), sent_.end(), 'S'), 1) << delay << " ms: " << sent_;
    EXPECT_LT(took_, SlcanOpening::kLongest) << delay;
  }
}

TEST_F(SlcanOpen, AnAdapterThatStillFloodsFramesIsOpenedAllTheSame) {
  const auto flooding = [](const std::string& command) {
    const auto answer = command == "C\r" ? std::string("\r") : lawicel(command);
    return command == "C\r" ? "0000000\rt5818430010009201\rt58184300100092010200\rt5818\r" + answer : answer;
  };
  EXPECT_EQ(open(flooding), OpeningState::open);
  EXPECT_EQ(sent_, "C\rV\rS6\rO\r");
}

TEST_F(SlcanOpen, FirmwareThatAcknowledgesNothingIsKnownByItsVersion) {
  EXPECT_EQ(open([](const std::string& command) {
              return command == "V\r" ? std::string("b158aa7 github.com/normaldotcom\r") : "";
            }),
            OpeningState::open);
  EXPECT_FALSE(acknowledges_);
  EXPECT_EQ(sent_, "C\rV\rV\rS6\rO\r");
  EXPECT_LT(took_, milliseconds(400));
}

TEST_F(SlcanOpen, AnAdapterWithoutAVersionIsOneByItsAcknowledges) {
  EXPECT_EQ(open([](const std::string& command) { return std::string(command == "V\r" ? "\a" : "\r"); }),
            OpeningState::open);
  sent_.clear();
  EXPECT_EQ(open([](const std::string& command) { return std::string(command == "V\r" ? "" : "\r"); }),
            OpeningState::open);
}

TEST_F(SlcanOpen, WhatAnswersNothingIsNoAdapter) {
  EXPECT_EQ(open([](const std::string&) { return std::string(); }), OpeningState::no_answer);
  EXPECT_FALSE(heard_something_);
  EXPECT_EQ(sent_, "C\rV\rC\rV\rC\rV\r") << "and nothing else was sent to it";
  EXPECT_LT(took_, milliseconds(5000));
}

TEST_F(SlcanOpen, AnEchoIsNoAdapter) {
  EXPECT_EQ(open([](const std::string& command) { return command; }), OpeningState::no_answer);
  EXPECT_TRUE(heard_something_);
}

TEST_F(SlcanOpen, ADeviceThatEchoesAndAnswersSomethingIsNoAdapter) {
  EXPECT_EQ(open([](const std::string& command) { return command + "\r\nERROR\r\n"; }),
            OpeningState::no_answer);
  EXPECT_EQ(sent_.find('S'), std::string::npos) << sent_;
  EXPECT_EQ(sent_.find('O'), std::string::npos) << sent_;
}

TEST_F(SlcanOpen, ADeviceThatSaysTheSameTextUnaskedIsNoAdapter) {
  EXPECT_EQ(open([](const std::string&) { return std::string("ready\r\n"); }), OpeningState::no_answer);
  EXPECT_EQ(sent_.find('S'), std::string::npos) << sent_;
  EXPECT_TRUE(heard_something_);
}

TEST_F(SlcanOpen, WhoCannotListenOnlyIsNotOpenedForIt) {
  const auto listens = SlcanOpening::Mode::listen_only;
  EXPECT_EQ(open([](const std::string& command) { return command == "L\r" ? "\a" : lawicel(command); },
                 milliseconds(1), listens),
            OpeningState::refused_listening);
  sent_.clear();
  EXPECT_EQ(open([](const std::string& command) { return std::string(command == "V\r" ? "b158aa7\r" : ""); },
                 milliseconds(1), listens),
            OpeningState::refused_listening);
  EXPECT_EQ(sent_, "C\rV\rV\r") << "nobody knows what it would do with L";
}

TEST_F(SlcanOpen, ADeviceThatTalksByItselfIsNoAdapter) {
  int line = 0;
  EXPECT_EQ(open([&](const std::string&) { return "$GPGGA," + std::to_string(++line) + ",4807.038,N\r\n"; }),
            OpeningState::no_answer);
  EXPECT_TRUE(heard_something_);
}

TEST_F(SlcanOpen, ARefusedBitrateIsTold) {
  EXPECT_EQ(open([](const std::string& command) { return command == "S6\r" ? "\a" : lawicel(command); }),
            OpeningState::refused_bitrate);
  EXPECT_EQ(open([](const std::string& command) { return command == "O\r" ? "\a" : lawicel(command); }),
            OpeningState::refused_opening);
}

TEST_F(SlcanOpen, ALostAnswerCostsOneRound) {
  int seen = 0;
  EXPECT_EQ(open([&](const std::string& command) {
              return command == "S6\r" && ++seen == 1 ? std::string() : lawicel(command);
            }),
            OpeningState::open);
  EXPECT_EQ(sent_, "C\rV\rS6\rC\rV\rS6\rO\r");
}

}  // namespace
}  // namespace servoctl::can
