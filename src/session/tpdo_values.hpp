#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "canopen/pdo.hpp"
#include "session/hearing.hpp"

namespace servoctl::session {

/// The values that the TPDOs of one drive on a CAN bus bring of some objects, while it lives: it hears every
/// frame. Once the mapping no longer holds (CanNetwork::epoch()) it brings nothing more.
class TpdoValues final : public ProcessValues {
 public:
  /// A PDO that carries none of the objects, or is not valid, is left out. What is no whole number of bytes
  /// is a part of an object: take() does not give it, take_all() does.
  /// `pdos` hold now.
  TpdoValues(CanNetwork& network, std::uint8_t node, std::span<const canopen::Pdo> pdos,
             std::span<const ObjectAddress> objects);

  std::optional<Bytes> take(ObjectAddress object, TimePoint since) override;
  bool carries(ObjectAddress object) const override;
  void keep_all() override { keeps_all_ = true; }
  std::vector<Arrival> take_all() override { return std::exchange(arrivals_, {}); }

 private:
  struct Value {
    Bytes bytes;
    TimePoint time;
  };
  void on_frame(const can::Frame& frame, TimePoint time);
  bool holds() const { return network_->epoch(node_) == epoch_; }

  const CanNetwork* network_;
  std::uint8_t node_;
  canopen::NodeEpoch epoch_;
  std::vector<canopen::Pdo> pdos_;
  std::map<ObjectAddress, std::optional<Value>> values_;
  bool keeps_all_ = false;
  std::vector<Arrival> arrivals_;
  Hearing hearing_;
};

}  // namespace servoctl::session
