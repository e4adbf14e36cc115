#pragma once

#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "session/ethercat_node.hpp"
#include "session/network.hpp"

namespace servoctl::session {

/// Values of the inputs of one slave, while it gives any.
class EtherCatValues final : public ProcessValues {
 public:
  /// `node` outlives it.
  EtherCatValues(EtherCatNode& node, std::span<const ObjectAddress> objects);
  ~EtherCatValues() override;

  std::optional<Bytes> take(ObjectAddress object, TimePoint since) override;
  bool carries(ObjectAddress object) const override;
  void keep_all() override { keeps_all_ = true; }
  std::vector<Arrival> take_all() override { return std::exchange(arrivals_, {}); }

  /// Cycles may have come back; the network calls it whenever it served the image.
  void note();

 private:
  EtherCatNode* node_;
  std::vector<ObjectAddress> objects_;
  std::map<ObjectAddress, TimePoint> taken_;  ///< When the value was fetched that was given last.
  bool keeps_all_ = false;
  TimePoint noted_{};  ///< When the inputs were fetched that were kept last.
  std::vector<Arrival> arrivals_;
};

}  // namespace servoctl::session
