#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
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
  /// Errc::protocol where this object alone was not answered properly, or is longer than set_longest()
  /// allows. Errc::timeout if the node does not answer a read of 1000h either, Errc::refused after an EMCY
  /// (it may be the answer to a request for an object that the node lacks), Errc::bus, Errc::interrupted.
  Result<std::vector<Result<Bytes>>> read(std::span<const ObjectAddress> objects);
  /// From now on an EMCY ends nothing, and what the node's family says is an alarm there is asked for as
  /// well.
  void go_on_despite_alarms() { despite_alarms_ = true; }
  bool goes_on_despite_alarms() const { return despite_alarms_; }

  /// A read that brings more bytes is given up: a node may send without end.
  void set_longest(std::size_t bytes) { longest_ = bytes; }

  /// Whether an axis of the node is enabled now: see is_any_axis_energised().
  Result<bool> is_enabled();

 private:
  std::vector<Result<Bytes>> ask(std::span<const ObjectAddress> objects);
  std::vector<Result<Bytes>> transfer_limited(std::span<const SdoRequest> requests);
  Result<void> take(std::vector<Result<Bytes>>& answers, std::span<const ObjectAddress> objects,
                    std::vector<Result<Bytes>>& out);
  Result<void> check_alive(const Error& silence);
  Result<void> check_alarms(ObjectAddress last);

  Session* session_;
  std::uint8_t node_;
  std::uint32_t heard_;  ///< EMCYs before the last read.
  bool despite_alarms_ = false;
  static constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
  std::size_t longest_ = kNoLimit;
  bool is_too_long_ = false;  ///< The last request brought more than that.
};

}  // namespace servoctl::session
