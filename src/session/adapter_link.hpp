#pragma once

#include <memory>
#include <string>
#include <utility>

#include "can/link_change.hpp"
#include "can/slcan_place.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// The adapter behind the bus of a session, `slcan:PORT@RATE`, as an interface whose bitrate can be set: each
/// change takes effect when the session's network recovers.
class AdapterLink final : public can::LinkControl {
 public:
  AdapterLink(Session& session, can::SlcanPlace place);

  const std::string& name() const override { return name_; }
  Result<can::LinkState> state() override;
  Result<void> change(const can::LinkChange& change) override;
  /// Listens without acknowledging where the adapter can, else as the session does, which has left its bus
  /// and has to recover afterwards.
  Result<std::unique_ptr<can::Bus>> listen() override;

 private:
  Session* session_;
  can::SlcanPlace place_;
  std::string name_;
};

/// Puts the adapter of a session back to the bitrate in the name of its bus, on every way out; does nothing
/// on any other bus.
class NamedBitrate {
 public:
  explicit NamedBitrate(Session& session) : session_(&session) {}
  NamedBitrate(const NamedBitrate&) = delete;
  NamedBitrate& operator=(const NamedBitrate&) = delete;
  ~NamedBitrate();

 private:
  Session* session_;
};

}  // namespace servoctl::session
