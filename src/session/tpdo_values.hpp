#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "canopen/pdo.hpp"
#include "session/option_scope.hpp"

namespace servoctl::session {

/// The values that the TPDOs of one drive bring of some objects, while it lives: it hears every frame the
/// session receives.
class TpdoValues {
 public:
  /// A PDO that carries none of the objects, is not valid, or carries only a part of an object is left out.
  TpdoValues(Session& session, std::span<const canopen::Pdo> pdos, std::span<const ObjectAddress> objects);

  /// The value that came since `since`, each one once; empty when none has.
  std::optional<Bytes> take(ObjectAddress object, TimePoint since);

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
