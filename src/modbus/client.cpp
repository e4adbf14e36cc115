#include "modbus/client.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::modbus {
namespace {

/// USB adapters hand bytes on in bursts, up to 16 ms apart: only a longer pause is one of the line.
constexpr Duration kBurst = std::chrono::milliseconds(30);
/// A line on which others talk without end is not waited for any longer.
constexpr Duration kNoise = std::chrono::seconds(1);
/// Of a form: what is behind the function.
constexpr unsigned kFunctionAt = 40;
constexpr std::uint64_t kAnyLength = 0xFFFF;

bool is_write(ByteSpan pdu) { return pdu[0] == static_cast<std::uint8_t>(Function::write_register); }

bool is_read(ByteSpan pdu) { return pdu[0] >= 0x01 && pdu[0] <= 0x04; }

std::uint64_t form_of_write(ByteSpan pdu) {
  return std::uint64_t{load_be16(pdu.subspan(1))} << 16U | load_be16(pdu.subspan(3));
}

/// How many bytes of data an answer has.
std::uint64_t length_asked_for(ByteSpan pdu) {
  const auto count = load_be16(pdu.subspan(3));
  const bool bits = pdu[0] <= 0x02;
  return bits ? (count + 7U) / 8U : count * 2U;
}

/// Of an answer that is no refusal.
std::uint64_t answer_form(ByteSpan pdu) {
  const auto function = std::uint64_t{pdu[0]} << kFunctionAt;
  if (is_write(pdu) && pdu.size() == 5) return function | form_of_write(pdu);
  if (!is_read(pdu)) return function | kAnyLength;
  return function | (pdu.size() >= 2 && pdu.size() == pdu[1] + 2U ? pdu[1] : kAnyLength);
}

}  // namespace

Duration Client::gap_length() const { return std::max(silence(), kBurst); }

TimePoint Client::free_at(std::uint8_t unit) const {
  // The number of a message tells its answer; a write that is late may still be done.
  if (framing_ == Framing::tcp) return owed_until_[unit];
  auto quiet = stirred_at_ == TimePoint::min() ? stirred_at_ : stirred_at_ + silence();
  if (noise_since_ != kNever) quiet = std::min(quiet, noise_since_ + kNoise);
  return std::max(quiet, owed_until_[unit]);
}

/// The number of a message of TCP tells its answer. On a line it is the form: of a read its function and how
/// many bytes it asks for, of a write all of it.
AnswerForm Client::form_of(const Message& request) const {
  constexpr std::uint64_t kByNumber = std::uint64_t{1} << 63U;
  if (framing_ == Framing::tcp) return {request.unit, kByNumber | request.transaction};
  const ByteSpan pdu = request.pdu;
  const auto function = std::uint64_t{pdu[0]} << kFunctionAt;
  if (pdu.size() != 5 || !(is_write(pdu) || is_read(pdu))) return {request.unit, function | kAnyLength};
  return {request.unit, function | (is_write(pdu) ? form_of_write(pdu) : length_asked_for(pdu))};
}

Bytes Client::start(std::uint8_t unit, Bytes pdu, TimePoint now, Duration timeout, Asking asking) {
  // What came in between belongs to nobody.
  if (framing_ != Framing::tcp) in_.clear();
  request_ = Message{unit, ++transaction_, std::move(pdu)};
  const bool again = asking.again && last_ && last_->unit == unit && last_->pdu == request_->pdu;
  core_.set_timeout(timeout);
  core_.begin(again);
  late_.reset();
  check_.reset();
  check_answered_ = false;
  send_at_ = noise_since_ = kNever;
  so_far_ = {};
  const bool is_doubtful = !is_write(request_->pdu) && !core_.open().is_clear(form_of(*request_));
  if (!is_doubtful || asking.check.empty()) return put_on_wire(request_->pdu, now);
  check_ = Message{unit, transaction_, std::move(asking.check)};
  return put_on_wire(check_->pdu, now);
}

Bytes Client::put_on_wire(Bytes pdu, TimePoint now) {
  const Message message{request_->unit, request_->transaction, std::move(pdu)};
  const bool writes = is_write(message.pdu);
  core_.open().ask(form_of(message), writes ? std::optional<std::uint64_t>(0) : std::nullopt, now);
  core_.wait(now);
  asked_at_ = stirred_at_ = now;
  auto out = frame(framing_, message);
  // The answer to a write is what was sent: that an adapter hands it back is known by a read only.
  sent_ = framing_ != Framing::tcp && (!writes || echoes_) ? out : Bytes();
  held_.clear();
  return out;
}

Bytes Client::take_bytes(TimePoint now) {
  if (!request_ || now < send_at_) return {};
  send_at_ = kNever;
  return put_on_wire(request_->pdu, now);
}

std::optional<Outcome> Client::take_late(std::uint8_t unit, ByteSpan pdu) {
  if (!late_ || last_->unit != unit ||
      !std::equal(pdu.begin(), pdu.end(), last_->pdu.begin(), last_->pdu.end()))
    return std::nullopt;
  owed_until_[unit] = TimePoint{};
  return std::exchange(late_, std::nullopt);
}

void Client::abandon() {
  if (!request_) return;
  owe();
  request_.reset();
}

/// Its answer may come as late again.
void Client::owe() {
  last_ = request_;
  if (framing_ != Framing::tcp || is_write(request_->pdu))
    owed_until_[request_->unit] = asked_at_ + 2 * core_.timeout();
  core_.wait_until(kNever);
}

/// Whether these bytes, with those before them, may be the request that comes back.
bool Client::swallow_echo(ByteSpan bytes) {
  if (sent_.empty()) return false;
  held_.insert(held_.end(), bytes.begin(), bytes.end());
  const auto common = std::min(held_.size(), sent_.size());
  if (std::equal(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(common), sent_.begin())) {
    if (held_.size() < sent_.size()) return true;
    so_far_.echoed = true;
    echoes_ = true;
    held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(sent_.size()));
  }
  sent_.clear();
  in_.push(std::exchange(held_, {}));
  return true;
}

void Client::on_bytes(ByteSpan bytes, TimePoint now) {
  if (bytes.empty()) return;
  stirred_at_ = now;
  if (!request_ && noise_since_ == kNever) noise_since_ = now;
  if (!swallow_echo(bytes)) in_.push(bytes);
  take_messages(now);
}

void Client::take_messages(TimePoint now) {
  while (auto message = in_.take()) {
    if (!request_) {
      take_idle(*message, now);
      continue;
    }
    take(*message, now);
    if (core_.has_ended()) {
      stirred_at_ = now;
      request_.reset();
    }
  }
  so_far_.damaged += in_.take_damaged();
}

/// What comes while nothing is under way is late.
void Client::take_idle(const Message& message, TimePoint now) {
  if (settle(message, now) != OpenRequests::Fit::ours || !last_) return;
  lateness_ = {message.unit, now - asked_at_};
  const auto kind = fit(last_->pdu, message.pdu);
  if (kind != Fit::answer && kind != Fit::exception) return;
  late_ = Outcome{};
  late_->kind = kind == Fit::answer ? Outcome::Kind::answered : Outcome::Kind::refused;
  late_->pdu = message.pdu;
}

OpenRequests::Fit Client::settle(const Message& message, TimePoint now) {
  const bool awaited = request_.has_value();
  if (framing_ == Framing::tcp) return core_.open().settle(form_of(message), now, awaited);
  if (message.pdu.empty()) return OpenRequests::Fit::none;
  const auto function = message.pdu.front();
  if ((function & kExceptionBit) == 0)
    return core_.open().settle({message.unit, answer_form(message.pdu)}, now, awaited);
  const auto is_refused = [&](AnswerForm asked) {
    return asked.server == message.unit && asked.form >> kFunctionAt == (function & ~unsigned{kExceptionBit});
  };
  return core_.open().settle_refusal(is_refused, now, awaited);
}

void Client::take(const Message& message, TimePoint now) {
  const auto fits = settle(message, now);
  if (fits == OpenRequests::Fit::late && core_.open().lateness())
    lateness_ = {message.unit, *core_.open().lateness()};
  if (fits == OpenRequests::Fit::late) return;
  if (framing_ == Framing::tcp && fits == OpenRequests::Fit::none) return;
  if (message.unit != request_->unit) {
    so_far_.other_unit = message.unit;
    return;
  }
  if (!check_) return on_answer(message);
  if (fits == OpenRequests::Fit::ours) on_check(now);
}

void Client::on_answer(const Message& message) {
  switch (fit(request_->pdu, message.pdu)) {
    case Fit::other: so_far_.other_answer = true; return;
    case Fit::answer: so_far_.kind = Outcome::Kind::answered; break;
    case Fit::exception: so_far_.kind = Outcome::Kind::refused; break;
    case Fit::malformed: so_far_.kind = Outcome::Kind::malformed; break;
  }
  so_far_.pdu = message.pdu;
  if (lateness_ && lateness_->first == message.unit) lateness_.reset();
  core_.finish(so_far_);
}

void Client::on_check(TimePoint now) {
  check_answered_ = true;
  if (!core_.open().has(form_of(*check_))) return send_behind_check(now);
  core_.wait_for_quiet(now);
}

void Client::send_behind_check(TimePoint now) {
  check_.reset();
  send_at_ = now + silence();
  core_.wait_until(kNever);
}

/// What stands incomplete is no longer waited for.
void Client::close_message(TimePoint now) {
  sent_.clear();
  in_.push(std::exchange(held_, {}));
  in_.on_silence();
  take_messages(now);
}

void Client::on_time(TimePoint now) {
  const bool gap = framing_ == Framing::rtu && incomplete() && now - stirred_at_ >= gap_length();
  const bool over = request_ && core_.is_due(now);
  if (gap || over) close_message(now);
  if (!request_ || !over) return;
  // The unit answers, and nothing that is older came.
  if (check_ && check_answered_) {
    core_.open().forget_older();
    return send_behind_check(now);
  }
  so_far_.kind = Outcome::Kind::silent;
  if (lateness_ && lateness_->first == request_->unit) so_far_.late = lateness_->second;
  owe();
  core_.finish(so_far_);
  request_.reset();
}

std::optional<Outcome> Client::take_outcome() { return core_.take_end(); }

TimePoint Client::deadline() const {
  if (!request_) return kNever;
  const auto until = std::min(core_.deadline(), send_at_);
  const bool waits_for_gap = framing_ == Framing::rtu && incomplete();
  return waits_for_gap ? std::min(until, stirred_at_ + gap_length()) : until;
}

void Client::reset() {
  in_.clear();
  request_.reset();
  check_.reset();
  last_.reset();
  late_.reset();
  (void)core_.take_end();
  core_.open().clear();
  send_at_ = kNever;
  held_.clear();
  sent_.clear();
  stirred_at_ = TimePoint::min();
  owed_until_.fill(TimePoint{});
}

}  // namespace servoctl::modbus
