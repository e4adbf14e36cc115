#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/time.hpp"

namespace servoctl {

/// What the answer to a request looks like: two requests of one server with equal forms cannot be told apart
/// by their answers.
struct AnswerForm {
  std::uint8_t server = 0;
  std::uint64_t form = 0;
  bool operator==(const AnswerForm&) const = default;
};

/// The requests that may still be answered, in the order in which they were sent. A server answers one
/// request after the other: an answer is for the oldest request whose form it has, and what that server was
/// asked before that one is not answered any more.
class OpenRequests {
 public:
  enum class Fit : std::uint8_t {
    ours,  ///< An answer to the present transfer.
    late,  ///< To an earlier transfer, or to another master.
    none,  ///< Nobody asked for it.
  };

  /// A transfer begins: what was asked before is not its own. `again`: it is a further try of the read before
  /// it, so that a late answer to that one is an answer to it as well.
  void begin(bool again);
  /// A request of the present transfer goes out. `value` says what it writes: one answer serves for requests
  /// that write the same. Empty for a read.
  void ask(AnswerForm answer, std::optional<std::uint64_t> value, TimePoint now);
  /// Another master, or another client of this process, sends a request.
  void overhear(AnswerForm answer, std::optional<std::uint64_t> value, TimePoint now);
  /// An answer came that confirms its request. `awaited`: the present transfer waits for one. What comes
  /// twice in a row may be one answer that was doubled, and leaves open what nobody waits for, and what was
  /// asked before the first of them came.
  Fit settle(AnswerForm came, TimePoint now, bool awaited = true);
  /// A refusal came, for a request whose form `is_refused` accepts.
  Fit settle_refusal(const std::function<bool(AnswerForm)>& is_refused, TimePoint now, bool awaited = true);
  /// Until when a second copy of the last answer may come that would be taken for that to a request of this
  /// form: of a server whose answers come twice. Empty where a request can go out at once.
  std::optional<TimePoint> copy_due(AnswerForm answer, TimePoint now) const;
  /// A copy came of an answer that the caller tells apart itself.
  void note_copy();
  /// A later answer came that the caller tells apart itself: no copy of the last one here is under way.
  void pass_copy() { has_copy_ = true; }
  /// The time of copy_due() is over, and none came.
  void miss_copy();
  /// Whether an answer of this form can be for the present transfer alone.
  bool is_clear(AnswerForm answer) const;
  /// Whether a request of this form is open.
  bool has(AnswerForm answer) const;
  /// Whether something else than the present transfer may still be answered.
  bool has_older() const;
  /// Nothing that was asked so far is answered any more, the present transfer apart.
  void forget_older();
  /// The present transfer was answered, in whatever form.
  void forget_own();
  /// Nothing is answered any more.
  void clear() { open_.clear(); }
  /// How long after its request the last answer came, if that was too late; empty when it was in time.
  std::optional<Duration> lateness() const { return lateness_; }

 private:
  struct Request {
    AnswerForm answer;
    std::optional<std::uint64_t> value;
    TimePoint sent;
    std::uint64_t transfer;   ///< 0: of somebody else.
    bool has_waited = false;  ///< Something else was answered since it was sent.
  };

  struct Answer {
    AnswerForm form;
    bool refuses = false;
    bool operator==(const Answer&) const = default;
  };

  void add(Request request);
  bool repeats(Answer answer, TimePoint now);
  Fit settle_confirmation(AnswerForm came, TimePoint now, bool awaited, bool again);
  Fit look_for_copy(Fit fit, bool again);
  bool may_be_copy(const Request& answered, bool awaited) const;
  Fit take(std::vector<Request>::iterator answered, TimePoint now);

  std::vector<Request> open_;  ///< Oldest first.
  std::uint64_t transfer_ = 1;
  std::optional<Answer> last_;  ///< That came.
  TimePoint last_at_{};
  bool has_copy_ = false;  ///< The last answer came a second time.
  int copies_ = 0;         ///< Above 0: answers come twice. Each copy that does not come takes one away.
  std::optional<Duration> lateness_;
};

/// What a message about silence says of an answer that came so long after its request.
std::string lateness_text(Duration late);
/// What to do about it: `it answers after 0.7 s: --timeout 2s`.
std::string lateness_hint(Duration late);

}  // namespace servoctl
