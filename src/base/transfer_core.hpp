#pragma once

#include <optional>
#include <utility>

#include "base/open_requests.hpp"
#include "base/time.hpp"

namespace servoctl {

/// What the clients of CAN, CoE and Modbus have in common: the time that an answer may take, the requests
/// that may still be answered, one end of each transfer. What messages look like is their own. `End` is what
/// becomes of a transfer.
template <class End>
class TransferCore {
 public:
  explicit TransferCore(Duration timeout) : timeout_(timeout) {}

  Duration timeout() const { return timeout_; }
  void set_timeout(Duration timeout) { timeout_ = timeout; }

  /// As OpenRequests::begin(); an end that nobody took is forgotten.
  void begin(bool again) {
    open_.begin(again);
    end_.reset();
  }
  OpenRequests& open() { return open_; }
  const OpenRequests& open() const { return open_; }

  /// The other side's time begins now.
  void wait(TimePoint now) { deadline_ = now + timeout_; }
  void wait_until(TimePoint deadline) { deadline_ = deadline; }
  /// The other side answers, and older answers may still come: where none comes for four times as long as an
  /// answer may take, they are lost.
  void wait_for_quiet(TimePoint now) { deadline_ = now + 4 * timeout_; }
  TimePoint deadline() const { return deadline_; }
  bool is_due(TimePoint now) const { return now >= deadline_; }

  void finish(End end) {
    deadline_ = kNever;
    end_ = std::move(end);
  }
  bool has_ended() const { return end_.has_value(); }
  /// Set once.
  std::optional<End> take_end() { return std::exchange(end_, std::nullopt); }

 private:
  Duration timeout_;
  TimePoint deadline_ = kNever;
  OpenRequests open_;
  std::optional<End> end_;
};

}  // namespace servoctl
