#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/result.hpp"
#include "base/time.hpp"
#include "ethercat/al_status.hpp"
#include "ethercat/request.hpp"

namespace servoctl::ethercat {

/// How long a slave may take for one step, where nobody knows better (its ESI may): what other masters allow.
Duration al_timeout(AlState from, AlState target);

/// Takes one slave from its state to another by one step (ETG.1000.6, 6.4.1; ETG.1000.4, 0120h and 0130h): an
/// error that stands is acknowledged first, then the state is asked for and waited for. Performs no I/O and
/// reads no clock; a Carrier takes its requests. What a step needs (sync managers, process data that flow) is
/// the caller's.
class AlRequest {
 public:
  /// `node` 1..127 is for messages.
  AlRequest(std::uint8_t node, SlaveAddress slave) : node_(node), slave_(slave) {}

  /// Asks for `target`; a slave that is there already and has no error is asked for nothing.
  void start(AlState target, TimePoint now, std::optional<Duration> timeout = {});
  /// Looks only: the result is what the slave says now, error or not.
  void start_look(TimePoint now);

  std::optional<Request> take_request();
  void on_answer(const Answer& answer, TimePoint now);
  void on_time(TimePoint now);
  TimePoint deadline() const { return deadline_; }
  bool busy() const { return state_ != State::idle; }
  /// Set once: the state it has now. Errc::negative when it refuses, with the code in words; Errc::timeout
  /// when it stays where it is, or is not there.
  std::optional<Result<AlStatus>> take_result();
  /// The error that stood when this began, and was acknowledged.
  const std::optional<AlStatus>& found() const { return found_; }

 private:
  enum class State : std::uint8_t { idle, look, acknowledge, acknowledged, ask, wait };

  void go(State state, TimePoint now, Duration pause = Duration{});
  void on_status(AlStatus status, TimePoint now);
  void on_missing(bool lost, TimePoint now);
  void wait_on(AlStatus status, TimePoint now);
  void finish(Result<AlStatus> result);
  Error error(Errc code, Message what, Message hint) const;

  std::uint8_t node_;
  SlaveAddress slave_;
  State state_ = State::idle;
  bool look_only_ = false;
  bool asking_ = false;
  AlState target_ = AlState::none;
  std::optional<Duration> timeout_;
  TimePoint until_;
  TimePoint deadline_ = kNever;
  AlStatus status_;  ///< Heard last.
  std::optional<AlStatus> found_;
  std::optional<Result<AlStatus>> result_;
};

}  // namespace servoctl::ethercat
