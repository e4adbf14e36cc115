#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "modbus/framing.hpp"
#include "modbus/pdu.hpp"

namespace servoctl::modbus {

/// What became of a request.
struct Outcome {
  enum class Kind : std::uint8_t { answered, refused, silent, malformed };
  Kind kind = Kind::silent;
  Bytes pdu;  ///< What the unit answered; empty where it was silent.
  /// What came in instead while nobody answered.
  std::size_t damaged = 0;                 ///< Bytes that were no message.
  std::optional<std::uint8_t> other_unit;  ///< A unit that answered and was not asked.
  bool other_answer = false;               ///< The unit answered something that was not asked.
  bool echoed = false;                     ///< The request itself came back, and nothing else.
};

/// The side of a line that asks: one request at a time, with the times between them. No I/O and no clock.
///
/// An answer of RTU and ASCII to a read does not say which register it is of. So a unit that did not answer
/// in time is given as long again before it is asked anew: what comes until then is the late answer, and is
/// dropped. One that answers later still cannot be told from a wrong answer: the time-out has to be longer.
class Client {
 public:
  explicit Client(Framing framing) : framing_(framing), in_(framing, Deframer::Expects::answers) {}

  Framing framing() const { return framing_; }
  /// The silence that ends a message and stands before the next one; RTU alone has one.
  void set_silence(Duration silence) { silence_ = silence; }
  Duration silence() const { return framing_ == Framing::rtu ? silence_ : Duration::zero(); }

  bool busy() const { return request_.has_value(); }
  /// From when on a request may go to the unit; not while busy().
  TimePoint free_at(std::uint8_t unit) const;
  /// The bytes to send now. Not to be called while busy().
  Bytes start(std::uint8_t unit, Bytes pdu, TimePoint now, Duration timeout);
  /// Nobody wants the answer any more; it may still come.
  void abandon();

  void on_bytes(ByteSpan bytes, TimePoint now);
  void on_time(TimePoint now);
  std::optional<Outcome> take_outcome();
  /// When on_time() has something to do; kNever while nothing is under way.
  TimePoint deadline() const;
  /// The stream cannot be understood any more: it is to be opened anew.
  bool broken() const { return in_.broken(); }
  /// The line was lost and is there again: what was under way ends without an outcome.
  void reset();

 private:
  bool swallow_echo(ByteSpan bytes);
  void take_messages(TimePoint now);
  void take(const Message& message);
  void close_message(TimePoint now);
  Duration gap_length() const;
  bool incomplete() const { return in_.pending() || !held_.empty(); }

  Framing framing_;
  Deframer in_;
  Duration silence_ = Duration::zero();
  std::optional<Message> request_;
  Outcome so_far_;
  std::optional<Outcome> outcome_;
  TimePoint until_ = kNever;
  TimePoint stirred_at_ = TimePoint::min();  ///< When something last was on the line.
  Duration timeout_ = Duration::zero();
  std::uint16_t transaction_ = 0;
  void owe();

  std::array<TimePoint, 256> owed_until_{};  ///< Of each unit: an answer may come that is late.
  Bytes sent_;                               ///< While the adapter may hand it back.
  Bytes held_;                               ///< What may become that.
  bool echoes_ = false;                      ///< It was seen to.
};

}  // namespace servoctl::modbus
