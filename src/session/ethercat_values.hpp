#pragma once

#include <map>
#include <optional>

#include "session/ethercat_node.hpp"
#include "session/network.hpp"

namespace servoctl::session {

/// Values of the inputs of one slave, while it gives any.
class EtherCatValues final : public ProcessValues {
 public:
  explicit EtherCatValues(const EtherCatNode& node) : node_(&node) {}

  std::optional<Bytes> take(ObjectAddress object, TimePoint since) override;

 private:
  const EtherCatNode* node_;
  std::map<ObjectAddress, TimePoint> taken_;  ///< When the value was fetched that was given last.
};

}  // namespace servoctl::session
