// A gateway at which a drive is exchanged for one that raises an alarm when it is asked for an object that it
// does not have: what was found out of the first one does not hold for the second.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "can/bus.hpp"
#include "session/gateway_server.hpp"
#include "session/session.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

const std::vector<std::filesystem::path> kExchangeFolders{std::filesystem::path(source_dir()) / "eds"};

/// Node 1 of a bus: a gsd600, then nobody, then a da200. One clock goes on through all three.
class ExchangeBus final : public can::Bus {
 public:
  enum class Part : std::uint8_t { first, nobody, second };

  ExchangeBus() : first_(drive("gsd600@1")), second_(drive("da200@1")) {}

  void go_to(Part part) {
    const auto time = now();
    part_ = part;
    past_ = time - current().now();
  }
  /// Takes what the second drive says as it starts: it was switched on while its cable was out.
  void drop_start() {
    while (*second_->receive(second_->now())) {
    }
  }
  bool raised_alarm() const { return raised_alarm_; }

  TimePoint now() const override { return current().now() + past_; }
  TimePoint next_event() const override {
    const auto next = current().next_event();
    return next == kNever ? kNever : next + past_;
  }
  Result<void> send(const can::Frame& frame) override {
    return part_ == Part::nobody ? Result<void>() : current().send(frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    auto frame = current().receive(deadline == kNever ? kNever : deadline - past_);
    if (part_ == Part::nobody) return std::optional<can::Frame>();
    if (frame && *frame && (**frame).id == 0x081 && (**frame).data[3] == 26) raised_alarm_ = true;
    return frame;
  }

 private:
  static std::unique_ptr<can::Bus> drive(std::string_view spec) {
    return std::move(sim::open_sim(spec, kExchangeFolders, sim::SimBus::Clock::virtual_time).value());
  }
  can::Bus& current() const { return part_ == Part::second ? *second_ : *first_; }

  std::unique_ptr<can::Bus> first_;
  std::unique_ptr<can::Bus> second_;
  Part part_ = Part::first;
  Duration past_{};
  bool raised_alarm_ = false;
};

class GatewayExchange : public testing::Test {
 protected:
  GatewayExchange() {
    auto made = std::make_unique<ExchangeBus>();
    bus = made.get();
    Options options;
    options.drive_folders = [] { return std::span<const std::filesystem::path>(kExchangeFolders); };
    session.emplace(std::unique_ptr<can::Bus>(std::move(made)), "test", std::move(options));
    server.emplace(*session, GatewayServer::Options{.writes = true, .version = "0.1"});
    server->on_client(1);
  }
  void run_for(Duration time) {
    const auto end = session->now() + time;
    while (session->now() < end) {
      ASSERT_TRUE(server->serve());
      ASSERT_TRUE(session->step(std::min({server->deadline(), session->next_event(), end})));
      (void)session->take_events();
    }
  }
  std::string ask(const std::string& line) {
    server->on_bytes(1, line + "\n");
    run_for(2s);
    return std::exchange(server->output(1), {});
  }

  ExchangeBus* bus = nullptr;
  std::optional<Session> session;
  std::optional<GatewayServer> server;
};

TEST_F(GatewayExchange, ABootUpEndsWhatWasFound) {
  EXPECT_EQ(ask("[1] 1 r 0x603F 0 u16"), "[1] 0\r\n");
  bus->go_to(ExchangeBus::Part::second);
  run_for(1s);
  EXPECT_TRUE(ask("[2] 1 r 0x603F 0 u16").starts_with("[2] ERROR:0x06020000"));
  EXPECT_FALSE(bus->raised_alarm());
}

TEST_F(GatewayExchange, ALostHeartbeatEndsWhatWasFound) {
  EXPECT_EQ(ask("[1] 1 w 0x1017 0 u16 100"), "[1] OK\r\n");
  EXPECT_EQ(ask("[2] 1 r 0x603F 0 u16"), "[2] 0\r\n");
  bus->go_to(ExchangeBus::Part::nobody);
  run_for(3s);
  bus->drop_start();
  bus->go_to(ExchangeBus::Part::second);
  EXPECT_TRUE(ask("[3] 1 r 0x603F 0 u16").starts_with("[3] ERROR:0x06020000"));
  EXPECT_FALSE(bus->raised_alarm());
}

TEST_F(GatewayExchange, SilenceEndsWhatWasFound) {
  EXPECT_EQ(ask("[1] 1 r 0x603F 0 u16"), "[1] 0\r\n");
  bus->go_to(ExchangeBus::Part::nobody);
  EXPECT_TRUE(ask("[2] 1 r 0x6041 0 u16").starts_with("[2] ERROR:0x05040000"));
  bus->drop_start();
  bus->go_to(ExchangeBus::Part::second);
  EXPECT_TRUE(ask("[3] 1 r 0x603F 0 u16").starts_with("[3] ERROR:0x06020000"));
  EXPECT_FALSE(bus->raised_alarm());
}

}  // namespace
}  // namespace servoctl::session
