#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "can/trace.hpp"
#include "canopen/sdo_observer.hpp"
#include "session/session.hpp"

namespace servoctl::traffic {

/// An SDO request that was sent and did not do what it was to do.
struct ReplayFailure {
  std::uint8_t node = 0;
  ObjectAddress object;
  bool write = false;
  std::optional<std::uint32_t> abort_code = {};  ///< Empty: no answer came.
};

/// Sends the frames of a recording and hears what drives answer to the SDO requests among them.
class ReplayRun {
 public:
  explicit ReplayRun(session::Session& session) : session_(&session) {}

  /// Keeps the time between the frames that the recording has, divided by `speed`; a time that goes back
  /// counts as none. Then waits for the answers that are missing, for the session's timeout at most.
  /// Errc::bus or interrupted; sent() is right in any case.
  Result<void> run(std::span<const can::LogFrame> frames, double speed);

  std::size_t sent() const { return sent_; }
  /// Refused requests and those without an answer, in the order in which that was noticed.
  const std::vector<ReplayFailure>& failures() const { return failures_; }
  /// Requests to which no drive gave an answer, only the recording did.
  std::size_t answered_by_recording() const { return answered_by_recording_; }

 private:
  struct Request {
    ObjectAddress object;
    bool write = false;
    bool in_recording = false;  ///< An answer to it was sent as well.
  };
  /// One SDO channel.
  struct Lane {
    canopen::SdoObserver live;      ///< What is sent to the drive and what it answers.
    canopen::SdoObserver recorded;  ///< The answers that are sent.
    std::deque<Request> open;
  };

  Result<void> send_all(std::span<const can::LogFrame> frames, double speed);
  void on_sent(const can::Frame& frame);
  void on_received(const can::Frame& frame);
  bool is_waiting() const;
  void close();

  session::Session* session_;
  std::array<Lane, 128> channels_;
  std::vector<ReplayFailure> failures_;
  std::size_t sent_ = 0;
  std::size_t answered_by_recording_ = 0;
};

}  // namespace servoctl::traffic
