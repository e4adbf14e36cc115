#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/object_address.hpp"
#include "canopen/pdo.hpp"
#include "drive/profile.hpp"
#include "session/hearing.hpp"

namespace servoctl::session {

/// While it lives, reports each object of one node that another master starts to write, by SDO and, after
/// learn_rpdos(), by RPDO. Where servoctl is the only master, as it is on any network but CAN, there is
/// nothing to report.
class ForeignWrites {
 public:
  /// A PDO reaches the object in the state operational only, and that may not be known.
  enum class Way : std::uint8_t { sdo, rpdo };
  using OnWrite = std::function<void(ObjectAddress object, Way way)>;

  ForeignWrites(Session& session, std::uint8_t node, OnWrite on_write);

  /// Reads which CAN-IDs write which objects of the node: RPDOs that are valid now. One that the node refuses
  /// to show is left out, and so is one that its data do not list and that it has no proper answer for.
  /// Errors of reading: timeout, protocol, bus, interrupted.
  Result<void> learn_rpdos(const drive::Profile& profile);

 private:
  void hear(const can::Frame& frame) const;

  Session* session_;
  std::uint8_t node_;
  OnWrite on_write_;
  std::vector<canopen::Pdo> rpdos_;
  Hearing hearing_;
};

}  // namespace servoctl::session
