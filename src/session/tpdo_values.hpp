#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "canopen/pdo.hpp"
#include "session/hearing.hpp"

namespace servoctl::session {

/// The values that the TPDOs of one drive on a CAN bus bring of some objects, while it lives: it hears every
/// frame.
class TpdoValues final : public ProcessValues {
 public:
  /// A PDO that carries none of the objects, is not valid, or carries only a part of an object is left out.
  TpdoValues(CanNetwork& network, std::span<const canopen::Pdo> pdos, std::span<const ObjectAddress> objects);

  std::optional<Bytes> take(ObjectAddress object, TimePoint since) override;

 private:
  struct Value {
    Bytes bytes;
    TimePoint time;
  };
  void on_frame(const can::Frame& frame, TimePoint time);

  std::vector<canopen::Pdo> pdos_;
  std::map<ObjectAddress, std::optional<Value>> values_;
  Hearing hearing_;
};

}  // namespace servoctl::session
