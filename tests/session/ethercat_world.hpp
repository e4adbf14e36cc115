#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "session/ethercat_network.hpp"
#include "session/session.hpp"
#include "sim/sim_port.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {

namespace test {

/// A second master on a wire that outlives it.
class BorrowedPort final : public ethernet::Port {
 public:
  /// `on_sent` is called behind every frame; outlives it.
  explicit BorrowedPort(ethernet::Port& port, const std::function<void()>& on_sent)
      : port_(&port), on_sent_(&on_sent) {}
  TimePoint now() const override { return port_->now(); }
  Result<void> send(ByteSpan frame) override {
    auto sent = port_->send(frame);
    if (*on_sent_) (*on_sent_)();
    return sent;
  }
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override { return port_->receive(deadline); }
  TimePoint next_event() const override { return port_->next_event(); }
  Result<void> recover(TimePoint deadline) override { return port_->recover(deadline); }

 private:
  ethernet::Port* port_;
  const std::function<void()>* on_sent_;
};

}  // namespace test

/// A session on a ring of simulated slaves, in virtual time.
class EtherCatTest : public testing::Test {
 protected:
  void open(const std::string& spec) {
    const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
    auto cell = sim::build_esc_cell(spec, folders, sim::SimClock(sim::SimClock::Kind::virtual_time).now());
    ASSERT_TRUE(cell) << cell.error().message.text();
    port_ =
        std::make_unique<sim::SimPort>(std::move(*cell), sim::SimClock(sim::SimClock::Kind::virtual_time));
    session_ = connect();
  }
  /// One more program on the same wire; they must not wait at the same time.
  std::unique_ptr<Session> connect() { return connect(session_options_); }
  std::unique_ptr<Session> connect(Options options) {
    return std::make_unique<Session>(
        std::make_unique<EtherCatNetwork>(std::make_unique<test::BorrowedPort>(*port_, on_sent_), "coe:sim"),
        "coe:sim", std::move(options));
  }
  EtherCatNetwork& network() { return *session_->network().ethercat(); }
  sim::EscRing& ring() { return port_->cell().ring; }
  sim::EscSlave& slave(std::size_t index = 0) { return *port_->cell().slaves[index]; }
  drive::CoeRules rules() { return port_->cell().profiles.front()->rules.coe; }
  void pass(Duration time) {
    ASSERT_TRUE(session_->wait([] { return false; }, session_->now() + time));
  }

  Options session_options_;
  std::function<void()> on_sent_;  ///< Called when the slaves have had a frame.
  std::unique_ptr<sim::SimPort> port_;
  std::unique_ptr<Session> session_;
};

}  // namespace servoctl::session
