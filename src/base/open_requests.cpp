#include "base/open_requests.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "base/format.hpp"

namespace servoctl {
namespace {

/// More than that a server that is away is not asked before it is asked something else.
constexpr std::size_t kMostOpen = 64;
/// What doubles an answer, a hub or a driver, does it at once.
constexpr Duration kDouble = std::chrono::milliseconds(50);
/// After so many answers that came once, a server whose answers came twice is one like others.
constexpr int kCopiesMissed = 3;

}  // namespace

void OpenRequests::begin(bool again) {
  if (!again) ++transfer_;
}

void OpenRequests::add(Request request) {
  if (open_.size() == kMostOpen) open_.erase(open_.begin());
  open_.push_back(request);
}

void OpenRequests::ask(AnswerForm answer, std::optional<std::uint64_t> value, TimePoint now) {
  add({answer, value, now, transfer_});
}

void OpenRequests::overhear(AnswerForm answer, std::optional<std::uint64_t> value, TimePoint now) {
  add({answer, value, now, 0});
}

bool OpenRequests::repeats(Answer answer, TimePoint now) {
  const bool soon = now - std::exchange(last_at_, now) <= kDouble;
  return std::exchange(last_, answer) == answer && soon;
}

OpenRequests::Fit OpenRequests::settle(AnswerForm came, TimePoint now, bool awaited) {
  const bool again = repeats({came, false}, now);
  return look_for_copy(settle_confirmation(came, now, awaited, again), again);
}

/// Whether an answer that repeats the last one may be its copy, and not that to this request. If the request
/// was already open when the last one came, both are possible. To take a copy for its answer would drop what
/// was asked between the two, and the answer to that would be taken for one to a later request.
bool OpenRequests::may_be_copy(const Request& answered, bool awaited) const {
  return !awaited || answered.transfer != transfer_ || answered.has_waited;
}

/// What nobody waits for and repeats the last answer is a copy of it.
OpenRequests::Fit OpenRequests::look_for_copy(Fit fit, bool again) {
  for (auto& request : open_) request.has_waited = true;
  has_copy_ = again && fit != Fit::ours;
  if (has_copy_) note_copy();
  return fit;
}

void OpenRequests::note_copy() { copies_ = kCopiesMissed; }

std::optional<TimePoint> OpenRequests::copy_due(AnswerForm answer, TimePoint now) const {
  const bool may_come =
      copies_ > 0 && !has_copy_ && last_ && last_->form == answer && now - last_at_ < kDouble;
  return may_come ? std::optional(last_at_ + kDouble) : std::nullopt;
}

void OpenRequests::miss_copy() {
  --copies_;
  has_copy_ = true;
}

/// Where two requests write the same, it is all the same whose confirmation came: the value was written. It
/// is counted as that of the oldest, since the own request may still be answered.
OpenRequests::Fit OpenRequests::settle_confirmation(AnswerForm came, TimePoint now, bool awaited,
                                                    bool again) {
  const auto has_form = [&](const Request& request) { return request.answer == came; };
  const auto oldest = std::find_if(open_.begin(), open_.end(), has_form);
  if (oldest == open_.end()) return Fit::none;
  const auto other = std::find_if(oldest, open_.end(), [&](const Request& request) {
    return has_form(request) && (!request.value || request.value != oldest->value);
  });
  const auto own = std::find_if(oldest, other, [&](const Request& request) {
    return has_form(request) && request.transfer == transfer_;
  });
  const bool serves = own != other;
  if (again && may_be_copy(serves ? *own : *oldest, awaited)) return Fit::late;
  const auto fit = take(oldest, now);
  if (!serves) return fit;
  lateness_.reset();
  return Fit::ours;
}

OpenRequests::Fit OpenRequests::settle_refusal(const std::function<bool(AnswerForm)>& is_refused,
                                               TimePoint now, bool awaited) {
  const auto oldest = std::find_if(open_.begin(), open_.end(),
                                   [&](const Request& request) { return is_refused(request.answer); });
  // The request of a refusal that comes twice is no longer open: the second may be a copy, or for the next
  // one.
  const bool is_like_last = last_ && last_->refuses && is_refused(last_->form);
  const bool again = is_like_last && repeats(*last_, now);
  if (oldest == open_.end()) return look_for_copy(Fit::none, again);
  if (!again) (void)repeats({oldest->answer, true}, now);
  const bool is_copy = again && may_be_copy(*oldest, awaited);
  return look_for_copy(is_copy ? Fit::late : take(oldest, now), again);
}

OpenRequests::Fit OpenRequests::take(std::vector<Request>::iterator answered, TimePoint now) {
  const auto found = *answered;
  const auto last = std::next(answered);
  // Whether a request of somebody else came before one of ours is not known for sure.
  const auto is_over = [&](const Request& request) {
    return request.answer.server == found.answer.server && (found.transfer != 0 || request.transfer == 0);
  };
  open_.erase(std::remove_if(open_.begin(), last, is_over), last);
  if (found.transfer == transfer_) {
    lateness_.reset();
    return Fit::ours;
  }
  if (found.transfer != 0) lateness_ = now - found.sent;
  return Fit::late;
}

bool OpenRequests::is_clear(AnswerForm answer) const {
  return std::none_of(open_.begin(), open_.end(), [&](const Request& request) {
    return request.answer == answer && request.transfer != transfer_;
  });
}

bool OpenRequests::has(AnswerForm answer) const {
  return std::any_of(open_.begin(), open_.end(),
                     [&](const Request& request) { return request.answer == answer; });
}

bool OpenRequests::has_older() const {
  return std::any_of(open_.begin(), open_.end(),
                     [&](const Request& request) { return request.transfer != transfer_; });
}

void OpenRequests::forget_older() {
  std::erase_if(open_, [&](const Request& request) { return request.transfer != transfer_; });
}

void OpenRequests::forget_own() {
  std::erase_if(open_, [&](const Request& request) { return request.transfer == transfer_; });
}

std::string lateness_text(Duration late) {
  if (late < std::chrono::milliseconds(100))
    return formatted("; it answered an earlier request after {} ms", late / std::chrono::milliseconds(1));
  return formatted("; it answered an earlier request after {:.1f} s",
                   static_cast<double>(late.count()) / 1e6);
}

std::string lateness_hint(Duration late) {
  constexpr Duration kStep = std::chrono::milliseconds(100);
  constexpr Duration kSecond = std::chrono::seconds(1);
  const auto step = 2 * late < kSecond ? kStep : kSecond;
  const auto enough = (2 * late / step + 1) * step;
  return formatted("the drive answers later than it is waited for: use --timeout {}{}",
                   step == kSecond ? enough / kSecond : enough / std::chrono::milliseconds(1),
                   step == kSecond ? "s" : "ms");
}

}  // namespace servoctl
