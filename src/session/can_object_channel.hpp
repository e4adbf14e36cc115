#pragma once

#include <cstdint>
#include <utility>

#include "canopen/sdo_client.hpp"
#include "session/can_network.hpp"

namespace servoctl::session {

/// An SDO channel of the pre-defined connection set, of one node on a CAN bus. While it lives the network
/// gives it the frames of its node.
class CanObjectChannel final : public ObjectChannel {
 public:
  CanObjectChannel(CanNetwork& network, std::uint8_t node, Duration timeout);
  ~CanObjectChannel() override;

  /// A frame of its node.
  void on_frame(const can::Frame& frame, TimePoint now) {
    stirred_ = true;
    client_.on_frame(frame, now);
  }

  void set_timeout(Duration timeout) override { client_.set_timeout(timeout); }
  void start_upload(ObjectAddress object, TimePoint now, canopen::Transfer transfer,
                    std::size_t size) override;
  void try_again() override { again_ = true; }
  void start_download(ObjectAddress object, Bytes data, TimePoint now, canopen::Transfer transfer) override;
  Result<void> on_time(TimePoint now) override;
  /// The network learns from 1014h, read or written, under which CAN-ID the node sends emergencies.
  std::optional<Result<Bytes>> take_result() override;
  bool busy() const override { return client_.busy(); }
  TimePoint deadline() const override { return client_.deadline(); }
  std::size_t transferred() const override { return client_.transferred(); }
  std::optional<std::size_t> total() const override { return client_.total(); }

 private:
  friend class CanNetwork;

  CanNetwork* network_;
  canopen::SdoClient client_;
  ObjectAddress object_;                       ///< Of the present transfer.
  std::optional<std::uint32_t> emergency_id_;  ///< What it writes, or 1014h was read to hold.
  bool again_ = false;                         ///< As try_again() says.
  CanObjectChannel* next_;                     ///< Another of the same node.
};

}  // namespace servoctl::session
