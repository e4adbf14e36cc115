#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopen/nmt.hpp"
#include "gateway/client.hpp"
#include "gateway/connection.hpp"
#include "session/network.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {

class GatewayObjectChannel;

/// Whether the URL is that of a gateway: `gateway:…`.
bool is_gateway(std::string_view url);

/// Nodes behind a gateway of CiA 309-3, the ASCII form: objects are read and written as domains, so that
/// their bytes come as they are, whatever the gateway knows of their types; states are commanded. Nothing is
/// told unasked: no events, no states, no signs of life.
///
/// One request is under way at a time, whoever asks. No drive may be energised over it: when servoctl or its
/// connection is gone nobody would stop the motor.
class GatewayNetwork final : public Network {
 public:
  /// Connects, and asks whether it is one. Errc::usage for a URL that is not understood and for a trace,
  /// which there is none of; Errc::bus where there is none.
  static Result<std::unique_ptr<GatewayNetwork>> open(const std::string& url, const BusOptions& options);

  GatewayNetwork(gateway::Connection connection, gateway::Address address, std::string url)
      : connection_(std::move(connection)), address_(std::move(address)), url_(std::move(url)) {}
  ~GatewayNetwork() override;

  TimePoint now() const override { return steady_now(); }
  Result<bool> step(TimePoint deadline) override;
  TimePoint stepped_at() const override { return stepped_at_; }
  TimePoint next_event() const override;
  int poll_fd() const override { return connection_ ? connection_->get() : -1; }
  Result<void> recover(TimePoint deadline) override;
  void set_cancelled(std::function<bool()> cancelled) override { cancelled_ = std::move(cancelled); }
  std::unique_ptr<ObjectChannel> object_channel(std::uint8_t node, Duration timeout) override;
  const NodeRecords& records() const override { return records_; }
  std::optional<NodeEvent> take_event() override { return std::nullopt; }
  /// NMT: operational, pre-operational and stopped. Waits for the gateway's answer, which says that it was
  /// sent.
  Result<void> request_state(std::uint8_t node, NodeState state) override;
  Result<void> ask_state(std::uint8_t) override { return {}; }
  void doubt_state(std::uint8_t) override {}
  bool carries(LifeSign::Kind) const override { return false; }
  Result<void> arm_watchdog(std::uint8_t node, const LifeSign& sign) override;
  void disarm_watchdog(std::uint8_t) override {}
  void send_last_word(std::uint8_t node, ObjectAddress object, std::uint16_t value) noexcept override;
  std::unique_ptr<ProcessValues> process_values(std::uint8_t node,
                                                std::span<const ObjectAddress> objects) override;
  std::string_view state_title() const override { return "NMT state"; }
  bool takes_turns() const override { return true; }
  std::string_view why_no_power() const override;
  std::string silence_hint(std::uint8_t node) const override;
  GatewayNetwork* gateway() override { return this; }

  /// Any NMT command; `node` 0 is all. As request_state().
  Result<void> command(std::uint8_t node, canopen::NmtCommand command);
  /// Its line, without a number: `1 4 reset comm`.
  std::string command_line(std::uint8_t node, canopen::NmtCommand command) const;
  /// How long one node of many is waited for, when all are asked whether they are there.
  static constexpr Duration kScanPatience = std::chrono::milliseconds(100);

 private:
  friend class GatewayObjectChannel;

  class Records final : public NodeRecords {
   public:
    std::optional<NodeState> state(std::uint8_t) const override { return std::nullopt; }
    std::uint32_t boots(std::uint8_t) const override { return 0; }
    std::uint32_t heartbeats(std::uint8_t) const override { return 0; }
    const std::deque<canopen::Emergency>& emergencies(std::uint8_t) const override { return none_; }
    std::uint32_t alarms(std::uint8_t) const override { return 0; }

   private:
    std::deque<canopen::Emergency> none_;
  };

  /// Sends the next request when nothing is under way.
  Result<void> pump();
  Result<void> start(std::string_view request, Duration patience);
  Result<void> lose(Error error);
  Error gone() const;
  Error silent() const;
  void leave(GatewayObjectChannel& channel);
  void begin_anew();
  void hand_over(const gateway::Client::Outcome& outcome);
  /// Waits for the answer to a request of its own.
  Result<gateway::Answer> ask(std::string_view request, Duration patience);
  Result<void> introduce();
  std::string timeout_line() const;

  std::optional<gateway::Connection> connection_;  ///< None while it is lost.
  gateway::Address address_;
  std::string url_;
  gateway::Client client_;
  Records records_;
  std::function<bool()> cancelled_;
  std::deque<GatewayObjectChannel*> waiting_;  ///< In the order in which they asked.
  GatewayObjectChannel* asking_ = nullptr;     ///< Whose request is under way.
  bool setting_timeout_ = false;               ///< It is the one that sets `timeout_`.
  std::optional<gateway::Answer> own_;         ///< To the last request of its own.
  Duration timeout_{};                         ///< The SDO timeout that the gateway was told.
  bool takes_timeout_ = true;                  ///< It knows `set sdo_timeout`.
  bool names_network_ = false;                 ///< In front of it.
  TimePoint stepped_at_ = steady_now();
};

}  // namespace servoctl::session
