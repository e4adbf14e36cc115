#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/lss.hpp"

namespace servoctl::canopen {

/// The master of LSS (CiA 305): one request at a time. Performs no I/O and reads no clock: give it frames and
/// time, take frames and the result from it.
///
/// Any number of slaves may answer, and all answer under one identifier: after the first the machine goes on
/// listening for another. That nobody answers is a result, too, for it is what some questions are asked for.
/// Frames that are no answer to what was asked, such as late ones of an earlier request, are ignored.
class LssMaster {
 public:
  struct Options {
    Duration patience = std::chrono::milliseconds(500);  ///< From the request to the first answer.
    Duration further = std::chrono::milliseconds(100);   ///< From an answer to the next, of another slave.
    /// Between the frames of a request of several: slaves with one buffer lose the second otherwise.
    Duration gap = std::chrono::milliseconds(1);
  };
  /// Those who answered, in their order; those beyond kMostAnswers are not kept.
  using Answers = std::vector<LssAnswer>;
  static constexpr std::size_t kMostAnswers = 128;

  explicit LssMaster(Options options) : options_(options) {}

  /// Must not be called while a request is under way. One that nobody answers ends when its last frame is
  /// taken.
  void start(LssRequest request, TimePoint now);
  /// For the requests to come.
  void set_options(Options options) { options_ = options; }

  void on_frame(const can::Frame& frame, TimePoint now);
  void on_time(TimePoint now);
  std::optional<can::Frame> take_frame();
  /// Set once, when the request has ended.
  std::optional<Answers> take_result();
  TimePoint deadline() const {
    return deadline_;
  }  ///< When on_time() has something to do; kNever while idle.
  bool busy() const { return state_ != State::idle; }

 private:
  enum class State : std::uint8_t { idle, sending, listening };

  void finish();

  Options options_;
  State state_ = State::idle;
  LssRequest request_;
  std::size_t next_ = 0;  ///< Of the request's frames.
  TimePoint deadline_ = kNever;
  TimePoint at_most_ = kNever;  ///< Who goes on answering does not hold it up for ever.
  Answers answers_;
  std::optional<can::Frame> tx_;
  std::optional<Answers> result_;
};

}  // namespace servoctl::canopen
