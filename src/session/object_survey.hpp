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
  /// An EMCY of the node during a read: it may be the answer to the request for an object that it lacks.
  enum class OnAlarm : std::uint8_t { stop, go_on };

  ObjectSurvey(Session& session, std::uint8_t node, OnAlarm on_alarm = OnAlarm::stop);

  /// One answer for each object: its bytes, the refusal (Errc::sdo_abort), or Errc::timeout and
  /// Errc::protocol where this object alone was not answered properly. Errc::timeout if the node does not
  /// answer a read of 1000h either, Errc::refused after an EMCY, Errc::bus, Errc::interrupted.
  Result<std::vector<Result<Bytes>>> read(std::span<const ObjectAddress> objects);

  /// Whether an axis of the node is enabled now: see is_any_axis_energised().
  Result<bool> is_enabled();

  /// Reads that were sent.
  std::size_t requests() const { return requests_; }

 private:
  std::vector<Result<Bytes>> ask(std::span<const ObjectAddress> objects);
  Result<void> take(std::vector<Result<Bytes>>& answers, std::span<const ObjectAddress> objects,
                    std::vector<Result<Bytes>>& out);
  Result<void> check_alive(const Error& silence);
  Result<void> check_alarms(ObjectAddress last);

  Session* session_;
  std::uint8_t node_;
  OnAlarm on_alarm_;
  std::size_t requests_ = 0;
  std::uint32_t heard_;  ///< EMCYs before the last read.
};

}  // namespace servoctl::session
