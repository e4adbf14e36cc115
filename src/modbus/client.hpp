#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "base/transfer_core.hpp"
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
  std::optional<Duration> late;            ///< So long after an earlier request the unit answered that.
};

/// How a request is made.
struct Asking {
  bool again = false;  ///< It is a further try of the read before it, and a late answer to that one will do.
  Bytes check;         ///< A read that the unit answers, with an answer of another length than the request's.
};

/// The side of a line that asks: one request at a time, with the times between them. No I/O and no clock.
///
/// An answer of RTU and ASCII to a read does not say which register it is of. So a unit that did not answer
/// in time is given as long again before it is asked anew: what comes until then is the late answer. If none
/// came, one may still come that looks like the answer to the next read. Then a request goes first whose
/// answer has another length: behind that answer none is late.
class Client {
 public:
  explicit Client(Framing framing) : framing_(framing), in_(framing, Deframer::Expects::answers) {}

  Framing framing() const { return framing_; }
  /// The silence that ends a message and stands before the next one; RTU alone has one.
  void set_silence(Duration silence) { silence_ = silence; }
  Duration silence() const { return framing_ == Framing::rtu ? silence_ : Duration::zero(); }

  bool busy() const { return request_.has_value(); }
  /// From when on a request may go to the unit; not while busy(). A line that is never silent is waited for a
  /// second.
  TimePoint free_at(std::uint8_t unit) const;
  /// The bytes to send now. Not to be called while busy().
  Bytes start(std::uint8_t unit, Bytes pdu, TimePoint now, Duration timeout, Asking asking = {});
  /// What is to be sent behind a check; empty when there is nothing.
  Bytes take_bytes(TimePoint now);
  /// The answer to the request before, which came when it had been given up; for a further try of it.
  std::optional<Outcome> take_late(std::uint8_t unit, ByteSpan pdu);
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
  using Core = TransferCore<Outcome>;

  AnswerForm form_of(const Message& request) const;
  Bytes put_on_wire(Bytes pdu, TimePoint now);
  bool swallow_echo(ByteSpan bytes);
  void take_messages(TimePoint now);
  void take_idle(const Message& message, TimePoint now);
  void take(const Message& message, TimePoint now);
  OpenRequests::Fit settle(const Message& message, TimePoint now);
  void on_check(TimePoint now);
  void send_behind_check(TimePoint now);
  void on_answer(const Message& message);
  void owe();
  void close_message(TimePoint now);
  Duration gap_length() const;
  bool incomplete() const { return in_.pending() || !held_.empty(); }

  Framing framing_;
  Deframer in_;
  Duration silence_ = Duration::zero();
  Core core_{Duration::zero()};
  std::optional<Message> request_;
  std::optional<Message> check_;  ///< It is on the line in front of the request.
  std::optional<Message> last_;   ///< The request that was given up last.
  std::optional<Outcome> late_;   ///< The answer to `last_`.
  Outcome so_far_;
  bool check_answered_ = false;  ///< Perhaps an earlier check.
  /// The unit that answered late last, and so long after its request.
  std::optional<std::pair<std::uint8_t, Duration>> lateness_;
  TimePoint asked_at_{};
  TimePoint send_at_ = kNever;               ///< When the request goes out behind its check.
  TimePoint stirred_at_ = TimePoint::min();  ///< When something last was on the line.
  TimePoint noise_since_ = kNever;           ///< When something first came that nobody asked for.
  std::uint16_t transaction_ = 0;

  std::array<TimePoint, 256> owed_until_{};  ///< Of each unit: an answer may come that is late.
  Bytes sent_;                               ///< While the adapter may hand it back.
  Bytes held_;                               ///< What may become that.
  bool echoes_ = false;                      ///< It was seen to.
};

}  // namespace servoctl::modbus
