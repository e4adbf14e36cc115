#include <algorithm>
#include <utility>

#include "ethercat/coe_message.hpp"
#include "ethercat/mailbox.hpp"
#include "ethercat/words.hpp"

namespace servoctl::ethercat {
namespace {

/// Emergencies and events that nobody takes are not kept for ever.
constexpr std::size_t kKept = 64;

}  // namespace

void Mailbox::take_in(ByteSpan mailbox) {
  const auto message = parse_mailbox(mailbox);
  if (!message) {
    ++statistics_.damaged;
    return;
  }
  const auto whole = mailbox.first(kMailboxHeader + message->data.size());
  ++statistics_.received;
  if (is_old(whole)) return;
  count(*message);
  last_.assign(whole.begin(), whole.end());
  const bool emergency =
      message->type == MailboxType::coe && coe_service(message->data) == CoeService::emergency;
  if (emergency) {
    const auto told = coe_emergency(message->data, node_);
    if (told && emergencies_.size() < kKept) emergencies_.push_back(*told);
    return;
  }
  if (draining_) {
    ++statistics_.left_behind;
    return;
  }
  answered_ = true;
  if (message->type == MailboxType::error && message->data.size() >= 4)
    events_.push_back(Refusal{word_at(message->data, 2), out_.has_value()});
  else if (message->type == MailboxType::coe)
    events_.push_back(Message{Bytes(message->data.begin(), message->data.end()), out_.has_value()});
  else
    ++statistics_.foreign;
  if (events_.size() > kKept) events_.pop_front();
}

/// Of a slave that counts its messages, the same one once more is no other (ETG.1000.4, 5.6): asked for again
/// it may give what had come already, or it sends twice.
bool Mailbox::is_old(ByteSpan message) const {
  const bool is_numbered = counts_ && (message[5] >> 4U & 0x07U) != 0;
  return is_numbered && std::equal(message.begin(), message.end(), last_.begin(), last_.end());
}

void Mailbox::count(const MailboxView& message) {
  if (last_.empty()) return;
  const auto before = static_cast<std::uint8_t>(last_[5] >> 4U & 0x07U);
  if (before == 0 || message.counter == 0) return;
  if (skipped_ && counts_ && message.counter == next_mailbox_counter(next_mailbox_counter(before)))
    ++statistics_.missed;
  counts_ = counts_ || message.counter != before;
}

std::optional<Mailbox::Event> Mailbox::take_event() {
  if (events_.empty()) return std::nullopt;
  auto out = std::move(events_.front());
  events_.pop_front();
  return out;
}

std::optional<canopen::Emergency> Mailbox::take_emergency() {
  if (emergencies_.empty()) return std::nullopt;
  const auto out = emergencies_.front();
  emergencies_.pop_front();
  return out;
}

}  // namespace servoctl::ethercat
