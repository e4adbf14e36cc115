#include "session/exchange.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "canopen/nmt.hpp"
#include "session/can_network.hpp"
#include "session/session.hpp"
#include "tests/session/scripted_bus.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

/// A session that notes what it tells of its transfers and orders.
class Exchanges : public testing::Test {
 protected:
  void SetUp() override {
    auto owned = std::make_unique<ScriptedBus>();
    bus = owned.get();
    Options options;
    options.retries = 2;
    options.exchanged = [this](const Exchange& one) {
      const auto time = std::chrono::duration_cast<std::chrono::milliseconds>(one.ended - one.begun).count();
      auto text = std::to_string(one.node) + " " + to_string(one.object) + (one.written ? " write" : " read");
      if (one.written != nullptr) text += " " + to_hex(*one.written);
      text += one.result ? " ok " + to_hex(*one.result) : " " + std::string(name(one.result.error().code));
      told.push_back(text + " " + std::to_string(time) + " ms, " + std::to_string(one.tries));
    };
    options.ordered = [this](const Session&, std::uint8_t node, std::string_view order) {
      told.push_back(std::to_string(node) + " " + std::string(order));
    };
    session = std::make_unique<Session>(std::move(owned), "test", std::move(options));
  }

  ScriptedBus* bus = nullptr;
  std::unique_ptr<Session> session;
  std::vector<std::string> told;
};

TEST_F(Exchanges, TellWhatWasReadAndWhatWasWritten) {
  bus->on_send = [](ScriptedBus& it, const std::string& sent) {
    it.arrive(sent.starts_with("601#40") ? "581#4B41600050020000" : "581#6040600000000000", 3ms);
  };
  ASSERT_TRUE(session->upload(1, {0x6041, 0}));
  ASSERT_TRUE(session->download(1, {0x6040, 0}, Bytes{6, 0}));
  EXPECT_EQ(told, (std::vector<std::string>{"1 0x6041:0 read ok 50 02 3 ms, 1",
                                            "1 0x6040:0 write 06 00 ok  3 ms, 1"}));
}

TEST_F(Exchanges, TellARefusalASilenceAndHowOftenWasAsked) {
  ASSERT_FALSE(session->upload(9, {0x1000, 0}));
  bus->on_send = [](ScriptedBus& it, const std::string&) { it.arrive("581#8000100002000106"); };
  ASSERT_FALSE(session->download(1, {0x1000, 0}, Bytes{1}));
  EXPECT_EQ(told, (std::vector<std::string>{"9 0x1000:0 read no-answer 1500 ms, 3",
                                            "1 0x1000:0 write 01 sdo-abort 1 ms, 1"}));
}

TEST_F(Exchanges, TellOnlyWhatWasTried) {
  const std::vector<SdoRequest> requests(3, SdoRequest{9, {0x1000, 0}, {}});
  for (const auto& answer : session->transfer(requests)) EXPECT_FALSE(answer);
  EXPECT_EQ(told, (std::vector<std::string>{"9 0x1000:0 read no-answer 1500 ms, 3"}));
}

TEST_F(Exchanges, TellNmtCommandsWhoeverSendsThem) {
  ASSERT_TRUE(session->network().request_state(3, NodeState::operational));
  ASSERT_TRUE(session->can()->send(canopen::nmt_frame(canopen::NmtCommand::reset_communication, 0)));
  ASSERT_TRUE(session->can()->send(can::parse_frame("080#").value()));
  EXPECT_EQ(told, (std::vector<std::string>{"3 NMT \"start\"", "0 NMT \"reset-comm\""}));
}

}  // namespace
}  // namespace servoctl::session
