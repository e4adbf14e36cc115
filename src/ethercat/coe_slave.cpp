#include "ethercat/coe_slave.hpp"

#include <utility>
#include <variant>

namespace servoctl::ethercat {

void CoeSlave::serve(Ring& ring, TimePoint now) {
  do {
    take_events(now);
    hand_over(now);
    mailbox_.listen(client_.busy() || info_.busy(), now);
  } while (carrier_.serve(mailbox_, ring, now));
}

void CoeSlave::take_events(TimePoint now) {
  // Whose request is not written yet has no answer.
  const auto for_client = [&](bool early) {
    return !client_.may_send() && !(early && owner_ == Owner::client);
  };
  const auto for_info = [&](bool early) { return !info_.may_send() && !(early && owner_ == Owner::info); };
  while (const auto event = mailbox_.take_event()) {
    if (const auto* message = std::get_if<Mailbox::Message>(&*event)) {
      if (for_client(message->early))
        client_.on_message(message->data, now);
      else
        client_.on_early(message->data, now);
      if (for_info(message->early)) info_.on_message(message->data, now);
    } else if (const auto* refusal = std::get_if<Mailbox::Refusal>(&*event)) {
      // It does not say whose message it is about: that of the last one.
      if (owner_ != Owner::info && for_client(refusal->early)) client_.on_refusal(refusal->detail);
      if (owner_ != Owner::client && for_info(refusal->early)) info_.on_refusal(refusal->detail);
    } else if (const auto* failure = std::get_if<Mailbox::Failure>(&*event)) {
      if (owner_ == Owner::client) client_.on_failure(failure->code, failure->what, failure->hint);
      if (owner_ == Owner::info) info_.on_failure(failure->code, failure->what, failure->hint);
      owner_ = Owner::nobody;
    }
  }
}

/// A request that nobody waits for any more must not be done later on.
void CoeSlave::drop_what_is_over() {
  const bool over = (owner_ == Owner::client && !client_.busy()) || (owner_ == Owner::info && !info_.busy());
  if (!over) return;
  owner_ = Owner::nobody;
  mailbox_.cancel();
}

/// One message at a time. The mailbox gives up a little before who waits for the answer does, and knows
/// better why.
void CoeSlave::hand_over(TimePoint now) {
  // What nobody waits for any more (an abort) makes room: a full mailbox is the next one's to tell.
  if (mailbox_.sending() && !(owner_ == Owner::nobody && mailbox_.is_stuck())) return;
  if (auto message = client_.take_message()) {
    owner_ = client_.busy() ? Owner::client : Owner::nobody;
    return mailbox_.send(std::move(*message), now + client_.timeout() * 9 / 10, now);
  }
  if (auto message = info_.take_message()) {
    owner_ = info_.busy() ? Owner::info : Owner::nobody;
    mailbox_.send(std::move(*message), now + info_.timeout() * 9 / 10, now);
  }
}

void CoeSlave::on_time(TimePoint now) {
  mailbox_.on_time(now);
  client_.on_time(now);
  info_.on_time(now);
  drop_what_is_over();
}

}  // namespace servoctl::ethercat
