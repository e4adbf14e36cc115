#include "sim/esc_mailbox.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::sim {
namespace {

constexpr std::size_t kMailboxHeader = 6;
constexpr std::uint8_t kErrorType = 0;
constexpr std::uint8_t kCoeType = 3;
constexpr std::uint8_t kLastCounter = 7;

/// Details of a mailbox error (ETG.1000.4, table 30).
constexpr std::uint16_t kProtocolError = 2;
constexpr std::uint16_t kChannelError = 3;
constexpr std::uint16_t kSizeError = 8;

}  // namespace

void EscMailbox::start() {
  stop();
  runs_ = true;
}

void EscMailbox::stop() {
  runs_ = false;
  last_request_ = 0;
  counter_ = 0;
  waiting_.clear();
  returned_.clear();
  present_.clear();
  last_read_.clear();
}

TimePoint EscMailbox::deadline() const {
  if (!runs_ || waiting_.empty() || in_->is_full()) return kNever;
  return waiting_.front().due;
}

void EscMailbox::on_time(TimePoint now) {
  if (!runs_) return;
  if (in_->take_read()) last_read_ = std::exchange(present_, {});
  if (in_->wants_repeat()) on_repeat();
  fill(now);
  // A request waits in its mailbox until the answers to the one before are on their way.
  if (out_->is_full() && !faults_->mailbox_stays_full && waiting_.empty()) {
    const auto message = out_->take();
    on_message(message, now);
  }
  fill(now);
}

/// The last message that was read comes again; one that lies there unread comes after it.
void EscMailbox::on_repeat() {
  if (!faults_->no_repeat && !last_read_.empty()) {
    if (in_->is_full()) returned_.push_front(in_->recall());
    in_->put(last_read_);
    present_ = last_read_;
  }
  in_->confirm_repeat();
}

void EscMailbox::on_message(ByteSpan message, TimePoint now) {
  if (faults_->silent_mailbox) return;
  if (message.size() < kMailboxHeader) return;
  const auto length = load_le(message.first(2));
  const unsigned channel = message[4] & 0x3FU;
  const unsigned type = message[5] & 0x0FU;
  const auto counter = static_cast<std::uint8_t>(message[5] >> 4U & 7U);
  if (counter != 0 && counter == std::exchange(last_request_, counter)) return;
  if (counter == 0) last_request_ = 0;
  if (type == kErrorType) return;
  if (length > message.size() - kMailboxHeader) return answer_error(kSizeError, now);
  if (channel != 0) return answer_error(kChannelError, now);
  if (type != kCoeType) return answer_error(kProtocolError, now);
  auto done = coe_->on_request(message.subspan(kMailboxHeader, length), in_->length() - kMailboxHeader);
  if (faults_->unanswered > 0) {
    --faults_->unanswered;
    return;
  }
  if (done.error != 0) return answer_error(done.error, now);
  for (auto& each : done.messages) answer(kCoeType, std::move(each), now);
}

void EscMailbox::answer_error(std::uint16_t detail, TimePoint now) {
  constexpr std::uint16_t kMailboxCommand = 1;
  auto data = store_le(kMailboxCommand, 2);
  const auto more = store_le(detail, 2);
  data.insert(data.end(), more.begin(), more.end());
  answer(kErrorType, std::move(data), now);
}

void EscMailbox::answer(std::uint8_t type, Bytes data, TimePoint now) {
  waiting_.push_back({type, std::move(data), now + faults_->answer_delay});
}

void EscMailbox::push(Bytes message, TimePoint now) {
  if (runs_) waiting_.push_back({kCoeType, std::move(message), now});
}

void EscMailbox::fill(TimePoint now) {
  if (in_->is_full() || !in_->is_enabled()) return;
  if (!returned_.empty()) {
    present_ = std::move(returned_.front());
    returned_.pop_front();
    return in_->put(present_);
  }
  if (waiting_.empty() || now < waiting_.front().due) return;
  const auto message = std::move(waiting_.front());
  waiting_.pop_front();
  counter_ = static_cast<std::uint8_t>(counter_ % kLastCounter + 1);
  const unsigned counter = faults_->uncounted_answers ? 0U : counter_;
  Bytes out = store_le(message.data.size(), 2);
  out.resize(kMailboxHeader);
  out[5] = static_cast<std::uint8_t>(message.type | counter << 4U);
  out.insert(out.end(), message.data.begin(), message.data.end());
  present_ = out;
  in_->put(out);
}

}  // namespace servoctl::sim
