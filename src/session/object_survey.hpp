#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// Reads many objects of one node, of which it may not have some. Writes nothing.
class ObjectSurvey {
 public:
  ObjectSurvey(Session& session, std::uint8_t node)
      : session_(&session), node_(node), heard_(session.watch().alarms(node)) {}

  /// One answer for each object: its bytes, the refusal (Errc::sdo_abort), or Errc::timeout and
  /// Errc::protocol where this object alone was not answered properly. Errc::timeout if the node does not
  /// answer a read of 1000h either, Errc::refused after an EMCY (it may be the answer to a request for an
  /// object that the node lacks), Errc::bus, Errc::interrupted.
  Result<std::vector<Result<Bytes>>> read(std::span<const ObjectAddress> objects);

  /// Whether an axis of the node is enabled now: see is_any_axis_energised().
  Result<bool> is_enabled();

 private:
  std::vector<Result<Bytes>> ask(std::span<const ObjectAddress> objects);
  Result<void> take(std::vector<Result<Bytes>>& answers, std::span<const ObjectAddress> objects,
                    std::vector<Result<Bytes>>& out);
  Result<void> check_alive(const Error& silence);
  Result<void> check_alarms(ObjectAddress last);

  Session* session_;
  std::uint8_t node_;
  std::uint32_t heard_;  ///< EMCYs before the last read.
};

}  // namespace servoctl::session
