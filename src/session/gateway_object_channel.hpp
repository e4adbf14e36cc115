#pragma once

#include <optional>
#include <string>
#include <utility>

#include "session/gateway_network.hpp"

namespace servoctl::session {

/// The way to the objects of one node behind a gateway.
///
/// What the gateway refuses by itself is Errc::refused (102) or Errc::usage (no such network or node), what
/// it does not understand Errc::protocol.
class GatewayObjectChannel final : public ObjectChannel {
 public:
  GatewayObjectChannel(GatewayNetwork& network, std::uint8_t node, Duration timeout)
      : network_(&network), node_(node), timeout_(timeout) {}
  ~GatewayObjectChannel() override;

  void set_timeout(Duration timeout) override { timeout_ = timeout; }
  void start_upload(ObjectAddress object, TimePoint now, canopen::Transfer transfer,
                    std::size_t size) override;
  /// Errc::usage for no bytes: CiA 309-3 has no such write.
  void start_download(ObjectAddress object, Bytes data, TimePoint now, canopen::Transfer transfer) override;
  Result<void> on_time(TimePoint now) override;
  std::optional<Result<Bytes>> take_result() override { return std::exchange(result_, std::nullopt); }
  bool busy() const override { return !request_.empty(); }
  TimePoint deadline() const override;
  std::size_t transferred() const override { return 0; }
  std::optional<std::size_t> total() const override { return std::nullopt; }

  const std::string& request() const { return request_; }
  Duration timeout() const { return timeout_; }
  /// How long the gateway may say nothing: a long object takes its time on the bus.
  Duration patience() const;
  void on_outcome(const gateway::Client::Outcome& outcome);
  /// The connection is lost: what was under way ends without a result.
  void forget();

 private:
  void ask(std::string request);
  Result<Bytes> result_of(const gateway::Client::Outcome& outcome) const;
  Error refusal(const gateway::Answer& answer) const;

  GatewayNetwork* network_;
  std::uint8_t node_;
  Duration timeout_;
  ObjectAddress object_;
  bool writes_ = false;
  std::string request_;  ///< Empty while nothing is under way.
  std::optional<Result<Bytes>> result_;
};

}  // namespace servoctl::session
