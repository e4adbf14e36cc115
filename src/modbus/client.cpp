#include "modbus/client.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::modbus {
namespace {

/// USB adapters hand bytes on in bursts, up to 16 ms apart: only a longer pause is one of the line.
constexpr Duration kBurst = std::chrono::milliseconds(30);

}  // namespace

Duration Client::gap_length() const { return std::max(silence(), kBurst); }

TimePoint Client::free_at(std::uint8_t unit) const {
  // The number of a message tells its answer; a write that is late may still be done.
  if (framing_ == Framing::tcp) return owed_until_[unit];
  const auto quiet = stirred_at_ == TimePoint::min() ? stirred_at_ : stirred_at_ + silence();
  return std::max(quiet, owed_until_[unit]);
}

Bytes Client::start(std::uint8_t unit, Bytes pdu, TimePoint now, Duration timeout) {
  // What came in between belongs to nobody.
  if (framing_ != Framing::tcp) in_.clear();
  request_ = Message{unit, ++transaction_, std::move(pdu)};
  so_far_ = {};
  outcome_.reset();
  timeout_ = timeout;
  until_ = now + timeout;
  stirred_at_ = now;
  auto out = frame(framing_, *request_);
  const bool reads = request_->pdu.front() != static_cast<std::uint8_t>(Function::write_register);
  // The answer to a write is what was sent: that an adapter hands it back is known by a read only.
  sent_ = framing_ != Framing::tcp && (reads || echoes_) ? out : Bytes();
  held_.clear();
  return out;
}

void Client::abandon() {
  if (!request_) return;
  owe();
  request_.reset();
}

/// Its answer may come as late again.
void Client::owe() {
  const bool writes = request_->pdu.front() == static_cast<std::uint8_t>(Function::write_register);
  if (framing_ != Framing::tcp || writes) owed_until_[request_->unit] = until_ + timeout_;
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
  if (!swallow_echo(bytes)) in_.push(bytes);
  take_messages(now);
}

void Client::take_messages(TimePoint now) {
  while (auto message = in_.take())
    if (request_) {
      take(*message);
      if (outcome_) {
        stirred_at_ = now;
        request_.reset();
      }
    }
  so_far_.damaged += in_.take_damaged();
}

void Client::take(const Message& message) {
  if (framing_ == Framing::tcp && message.transaction != request_->transaction) return;
  if (message.unit != request_->unit) {
    so_far_.other_unit = message.unit;
    return;
  }
  switch (fit(request_->pdu, message.pdu)) {
    case Fit::other: so_far_.other_answer = true; return;
    case Fit::answer: so_far_.kind = Outcome::Kind::answered; break;
    case Fit::exception: so_far_.kind = Outcome::Kind::refused; break;
    case Fit::malformed: so_far_.kind = Outcome::Kind::malformed; break;
  }
  so_far_.pdu = message.pdu;
  outcome_ = so_far_;
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
  const bool over = request_ && now >= until_;
  if (gap || over) close_message(now);
  if (!request_ || !over) return;
  so_far_.kind = Outcome::Kind::silent;
  owe();
  outcome_ = so_far_;
  request_.reset();
}

std::optional<Outcome> Client::take_outcome() { return std::exchange(outcome_, std::nullopt); }

TimePoint Client::deadline() const {
  if (!request_) return kNever;
  const bool waits_for_gap = framing_ == Framing::rtu && incomplete();
  return waits_for_gap ? std::min(until_, stirred_at_ + gap_length()) : until_;
}

void Client::reset() {
  in_.clear();
  request_.reset();
  outcome_.reset();
  held_.clear();
  sent_.clear();
  stirred_at_ = TimePoint::min();
  owed_until_.fill(TimePoint{});
}

}  // namespace servoctl::modbus
