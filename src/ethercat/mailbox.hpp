#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <variant>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "canopen/emergency.hpp"
#include "ethercat/mailbox_message.hpp"
#include "ethercat/request.hpp"
#include "ethercat/sii_image.hpp"

namespace servoctl::ethercat {

/// The mailbox of one slave (ETG.1000.4, 5.6 and 6.7): SM0 takes what the master writes, SM1 holds what the
/// slave answers. Performs no I/O and reads no clock; a Carrier takes its requests.
///
/// A message is written once. When the frame that wrote it is lost, or comes back uncounted, SM0 is looked
/// at: full, it is there; empty, it may have been taken already, so an answer is waited for and nothing is
/// written again, unless the slave counts nothing any more. An answer whose frame is lost is asked for again
/// (repeat request, 080Eh and 080Fh). What lies in SM1 when this begins was somebody else's and is thrown
/// away. Emergencies come out on their own, whenever they come.
class Mailbox {
 public:
  struct Options {
    SiiMailbox place;
    /// Of the first message. A slave that counts takes one with the number of the message before, by
    /// whomever, for a repetition: whoever does not bring the slave up from INIT begins with a number that
    /// changes.
    std::uint8_t first_counter = 1;
    Duration idle_poll =
        std::chrono::milliseconds(100);  ///< Between looks for emergencies while nobody waits; 0: none.
    Duration repeat_timeout = std::chrono::milliseconds(200);  ///< For an answer that was asked for again.
  };
  struct Statistics {
    std::uint64_t sent = 0;
    std::uint64_t received = 0;     ///< Messages of any kind.
    std::uint64_t left_behind = 0;  ///< Thrown away when this began.
    std::uint64_t foreign = 0;      ///< Of protocols that nobody here speaks.
    std::uint64_t damaged = 0;      ///< Their length led out of the mailbox.
    std::uint64_t repeated = 0;     ///< Asked for again.
    std::uint64_t missed = 0;       ///< Lost all the same.
    std::uint64_t doubtful =
        0;  ///< Written in a frame that was lost or not counted, and SM0 was empty behind it.
  };
  /// The slave did not like a message.
  struct Refusal {
    std::uint16_t detail = 0;  ///< See mailbox_error_text().
    bool early = false;        ///< As in Message.
  };
  /// It could not be sent.
  struct Failure {
    Errc code = Errc::timeout;
    std::string what;  ///< A phrase that goes behind the name of the node.
    std::string hint;
  };
  /// A CoE message came.
  struct Message {
    Bytes data;
    bool early = false;  ///< Something waited to be written then: whatever this answers, it is not that.
  };
  using Event = std::variant<Message, Refusal, Failure>;

  /// `node` 1..127 is for messages; a place with a doubt() is not used.
  Mailbox(std::uint8_t node, SlaveAddress slave, const Options& options);

  /// Begins, or begins anew after the slave was in INIT: empties SM1, counts from the first counter on.
  void start(TimePoint now);

  /// Hands a CoE message over, at most max_message() bytes. One that waits to be written is replaced. When
  /// SM0 is not free by `until` a Failure comes out.
  void send(Bytes message, TimePoint until, TimePoint now);
  /// What waits to be written is not, and what the slave has not taken is not tried again.
  void cancel();
  /// Whether somebody waits for an answer: SM1 is looked at again and again.
  void listen(bool yes, TimePoint now);

  std::optional<Request> take_request();
  void on_answer(const Answer& answer, TimePoint now);
  void on_time(TimePoint now);
  TimePoint deadline() const { return deadline_; }

  std::optional<Event> take_event();
  std::optional<canopen::Emergency> take_emergency();
  /// Bytes that one message can have, in either direction.
  std::size_t max_message() const {
    return std::max<std::size_t>(options_.place.out_size, kMailboxHeader) - kMailboxHeader;
  }
  /// A message waits to be written, or whether it was is being found out.
  bool sending() const { return out_ || writing_; }
  /// A message waits to be written and cannot: SM0 was full when it was looked at last.
  bool is_stuck() const { return out_ && !writing_ && full_; }
  const Statistics& statistics() const { return statistics_; }

 private:
  enum class State : std::uint8_t { idle, look, write, read, ask_repeat };
  enum class Recovery : std::uint8_t { none, read_lost, asked };
  struct Outgoing {
    Bytes message;
    TimePoint until;
  };

  void go(State state, TimePoint now, Duration pause = Duration{});
  void proceed(TimePoint now);
  void look_about(TimePoint now);
  void pause_and_look(TimePoint now);
  void on_looked(ByteSpan status, TimePoint now);
  bool recover(ByteSpan status, TimePoint now);
  void on_written(const Answer& answer, TimePoint now);
  void on_read(const Answer& answer, TimePoint now);
  void on_missing(bool lost, TimePoint now);
  void settle_doubt(TimePoint now);
  void count_sent(TimePoint now);
  bool waited_for() const;
  void take_in(ByteSpan mailbox);
  bool is_old(ByteSpan message) const;
  void count(const MailboxView& message);
  void take_coe(ByteSpan data);
  void give_up(std::string what, std::string hint);

  std::uint8_t node_;
  SlaveAddress slave_;
  Options options_;
  State state_ = State::idle;
  bool asking_ = false;     ///< A request is to be taken.
  bool under_way_ = false;  ///< It was taken, and is not answered.
  bool draining_ = true;    ///< What comes was left by somebody else.
  bool listening_ = false;
  bool full_ = false;      ///< SM0 was full when it was looked at last.
  bool free_ = false;      ///< SM0 was empty when it was looked at last, and nothing was written since.
  bool answered_ = false;  ///< Something came since the last message was written.
  Recovery recovery_ = Recovery::none;
  TimePoint recovery_until_;
  std::uint8_t activate_ = 0;  ///< Of SM1, as it was read last.
  std::uint8_t counter_ = 1;
  std::optional<Outgoing> out_;      ///< Waits to be written.
  std::optional<Outgoing> writing_;  ///< Was given to the wire.
  bool in_doubt_ = false;            ///< The frame that wrote it is lost, or nobody counted it.
  bool uncounted_ = false;           ///< The latter.
  bool cancelled_ = false;           ///< Nobody wants it any more.
  TimePoint waiting_since_;
  TimePoint deadline_ = kNever;
  Bytes last_;            ///< The message read last, with its header.
  bool counts_ = false;   ///< The slave counts its messages.
  bool skipped_ = false;  ///< What comes next may be the one after one that is lost.
  std::deque<Event> events_;
  std::deque<canopen::Emergency> emergencies_;
  Statistics statistics_;
};

}  // namespace servoctl::ethercat
