#pragma once

#include <optional>

#include "base/time.hpp"

namespace servoctl::session {

class Session;

/// What takes its time, for who looks on: what is known of its end. The session knows it as long as it lives.
class Stretch {
 public:
  /// Whether it goes on until then, or may be over before.
  enum class End { then, at_latest };

  /// From now on; `end`: kNever where it is not known.
  Stretch(Session& session, TimePoint end, End kind = End::then);
  Stretch(const Stretch&) = delete;
  Stretch& operator=(const Stretch&) = delete;
  ~Stretch();

  /// How much of the way is done, from 0 to 1.
  void set_share(double share) { share_ = share; }

  TimePoint begin() const { return begin_; }
  TimePoint end() const { return end_; }
  /// What is done at this time, where that can be said.
  std::optional<double> share(TimePoint now) const;

 private:
  Session* session_;
  TimePoint begin_;
  TimePoint end_;
  End kind_;
  std::optional<double> share_;
};

}  // namespace servoctl::session
