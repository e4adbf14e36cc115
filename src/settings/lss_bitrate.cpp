#include "settings/lss_bitrate.hpp"

#include <algorithm>
#include <utility>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "canopen/node_id.hpp"
#include "drive/bitrate.hpp"
#include "session/addressing.hpp"
#include "session/identify.hpp"
#include "session/option_scope.hpp"
#include "session/stretch.hpp"
#include "settings/lss_crowd.hpp"
#include "settings/lss_node.hpp"

namespace servoctl::settings {
namespace {

using canopen::kUnconfigured;
using canopen::LssRequest;
using canopen::LssService;
using drive::bitrate_text;
using session::LssDialogue;

/// All go back to waiting before the slaves change, and the interface takes its time behind it.
constexpr std::chrono::milliseconds kLeastDelay(250);
/// Behind the second silence: until the last of them talks again.
constexpr Duration kTalkAgain = std::chrono::milliseconds(100);
constexpr Duration kLookFor = std::chrono::seconds(5);
constexpr Duration kLookPause = std::chrono::seconds(1);

/// What holds after one of several slaves did not do as the others.
Message not_activated(const LssRequest& request, const Message& more) {
  const bool stores = request.answer == LssService::store;
  return message(
      "nothing was activated{}; {}",
      stores ? Message(", but slaves that confirmed have stored it, and take it when they are switched on")
             : Message(),
      more);
}

/// All who confirm; one that refuses is an error, and so is one of the `expected` that is silent.
Result<std::size_t> order_all(LssDialogue& lss, const LssRequest& request, std::size_t expected,
                              Duration patience) {
  const auto answers = lss.ask(request, patience);
  if (!answers) return fail(answers.error());
  if (answers->empty() && expected == 0)
    return fail(Errc::timeout, "no LSS slave answers on this bus", "many drives have no LSS");
  const bool asks = request.answer == LssService::inquire_node;
  const auto refused = std::find_if(answers->begin(), answers->end(),
                                    [&](const auto& answer) { return !asks && answer.error != 0; });
  if (refused != answers->end())
    return fail(Errc::negative,
                message("an LSS slave of {} refuses: {}", answers->size(), canopen::lss_error_text(*refused)),
                not_activated(request, "`lss inquire` shows what each slave is"));
  if (answers->size() < expected)
    return fail(Errc::negative,
                message("of {} LSS slaves {} confirmed what was set", expected, answers->size()),
                not_activated(request, "one that does not support a request may leave it unanswered"));
  return answers->size();
}

/// The slaves to another bitrate, and the interface with them.
class LssBitrateRun {
 public:
  LssBitrateRun(show::Desk& desk, const LssBitrateChange& change, BitrateSwitch& plan)
      : desk_(&desk), session_(desk.session), change_(&change), plan_(&plan) {}

  Result<LssBitrateOutcome> run() {
    // Between the activation and the interface nobody stops.
    std::optional<session::Deaf> deaf;
    {
      LssDialogue lss(*session_, session_->options().timeout);
      if (const auto set = configure(lss, deaf); !set) return fail(set.error());
      // Still at the old bitrate: what was activated waits for the delay first.
      if (const auto left = lss.leave(); !left) desk_->errors.push_back(left.error());
    }
    if (!plan_->follows() || !activated_) return std::move(out_);
    const auto gone = follow();
    deaf.reset();
    const auto found = gone ? find() : gone;
    if (!found) out_.error = found.error();
    return std::move(out_);
  }

 private:
  Result<void> configure(LssDialogue& lss, std::optional<session::Deaf>& deaf) {
    if (change_->all) {
      if (const auto reset = lss.ask(canopen::lss_switch_all(canopen::LssState::waiting)); !reset)
        return fail(reset.error());
      if (const auto sent = lss.select_all(); !sent) return sent;
    } else {
      const auto slave = lss.select(change_->address);
      if (!slave) return fail(slave.error());
      out_.address = slave->address;
      out_.slaves = 1;
    }
    for (const auto& request : lss_bitrate_requests(*change_)) {
      if (!request.answer && plan_->follows()) deaf.emplace(*session_);
      if (const auto done = order(lss, request); !done) return done;
    }
    return {};
  }

  Result<void> order(LssDialogue& lss, const LssRequest& request) {
    const auto patience = session_->options().timeout;
    const bool stores = request.answer == LssService::store;
    const auto wait = stores ? std::max(patience, kLssStorePatience) : patience;
    if (!request.answer) {
      const auto sent = lss.ask(request);
      activated_ = session_->now();
      return sent ? Result<void>() : fail(sent.error());
    }
    if (!change_->all)
      return lss.order(request, stores ? "stored its configuration" : "set its bitrate", wait);
    const auto done = order_all(lss, request, out_.slaves, wait);
    if (done) out_.slaves = *done;
    return done ? Result<void>() : fail(done.error());
  }

  /// The interface changes when the slaves have, and nobody talks.
  Result<void> follow() {
    const auto delay = std::chrono::milliseconds(*change_->delay_ms);
    const auto& name = plan_->link->name();
    desk_->tell(formatted("{} and the slaves go to {} in {}\n", name, bitrate_text(plan_->bitrate),
                          to_string(Duration(delay))));
    pause(*activated_ + delay);
    const auto set = take_to(*session_, *plan_, plan_->bitrate);
    if (!set)
      return fail(set.error().code,
                  message("the LSS slaves are at {} now, and {} could not follow: {}",
                          bitrate_text(plan_->bitrate), as_it_is(name), set.error().message),
                  set.error().hint);
    pause(*activated_ + 2 * delay + kTalkAgain);
    return {};
  }

  /// Whatever becomes of the bus meanwhile; one that does not come back is not waited for.
  void pause(TimePoint until) {
    const session::Stretch stretch(*session_, until);
    while (session_->now() < until)
      if (!session_->wait([] { return false; }, until) && !session_->network().recover(until)) return;
  }

  Result<void> find() {
    const auto until = session_->now() + kLookFor;
    const session::Stretch stretch(*session_, until, session::Stretch::End::at_latest);
    auto there = present();
    while ((!there || *there < out_.slaves) && session_->now() < until) {
      if (!there && there.error().code == Errc::interrupted) break;
      if (!there) (void)session_->network().recover(session_->now() + kLookPause);
      const auto waited = session_->wait([] { return false; }, session_->now() + kLookPause);
      there = waited || waited.error().code != Errc::interrupted ? present() : fail(waited.error());
    }
    // A bus that is disturbed, and silence, may be what a wrong bitrate looks like; nothing else is.
    if (!there && there.error().code != Errc::timeout && there.error().code != Errc::bus)
      return fail(not_looked_for(there.error()));
    return judge(there.value_or(0));
  }

  Result<void> judge(std::size_t there) {
    const auto& name = plan_->link->name();
    const auto rate = bitrate_text(plan_->bitrate);
    if (there == 0) return look_at_old();
    if (there < out_.slaves)
      return fail(
          Errc::timeout, message("of {} LSS slaves {} answer at {}", out_.slaves, there, rate),
          message("{} is at {} now; one that kept its bitrate disturbs the rest: switch it off, and on "
                  "where it has stored the new one",
                  as_it_is(name), rate));
    desk_->notices.push_back(message("{} went with them: {} (it was at {})", as_it_is(name), rate,
                                     session::settings_text(plan_->before)));
    return {};
  }

  Result<void> look_at_old() {
    const auto& name = plan_->link->name();
    const auto rate = bitrate_text(plan_->bitrate);
    const auto back = take_back(*session_, *plan_, [&] { return present().value_or(0) > 0; });
    if (back && *back)
      return fail(
          Errc::negative,
          message("LSS slaves still answer at {0}: the activation did not put {1} in force; {2} is at "
                  "{0} again",
                  old_bitrate_text(*plan_), rate, as_it_is(name)),
          change_->keep ? "what was stored holds when they are switched off and on: then `bus up` takes "
                          "the interface there"
                        : "one that does not support it may ignore it: --keep, and switch them off and on");
    return fail(Errc::timeout, message("no LSS slave answers at {}", rate),
                back ? message("{} has it now; switch the drives off and on, then `lss inquire` or `scan`",
                               as_it_is(name))
                     : Message("`bus status` shows the interface"));
  }

  Error not_looked_for(const Error& error) const {
    return make_error(error.code,
                      message("{} is at {} now; whether the LSS slaves are was not seen: {}",
                              as_it_is(plan_->link->name()), bitrate_text(plan_->bitrate), error.message),
                      "`lss inquire` or `scan` shows who answers");
  }

  /// How many of those that were told answer here.
  Result<std::size_t> present() {
    LssDialogue lss(*session_, session_->options().timeout);
    const auto answers = change_->all ? all_lss_answers(lss) : lss.ask(canopen::lss_select(*out_.address));
    const auto left = lss.leave();
    if (!answers) return fail(answers.error());
    if (!left) return fail(left.error());
    return answers->size();
  }

  show::Desk* desk_;
  session::Session* session_;
  const LssBitrateChange* change_;
  BitrateSwitch* plan_;
  LssBitrateOutcome out_;
  std::optional<TimePoint> activated_;
};

}  // namespace

std::vector<LssRequest> lss_bitrate_requests(const LssBitrateChange& change) {
  std::vector<LssRequest> out;
  if (change.all) out.push_back(canopen::lss_inquire(LssService::inquire_node));
  out.push_back(canopen::lss_set_bit_timing(change.index));
  if (change.keep) out.push_back(canopen::lss_store());
  if (change.delay_ms) out.push_back(canopen::lss_activate_bit_timing(*change.delay_ms));
  return out;
}

Result<BitrateSwitch> plan_lss_switch(std::unique_ptr<can::LinkControl> link, const LssBitrateChange& change,
                                      const std::optional<bool>& may_change) {
  if (!change.delay_ms || !change.bitrate) return BitrateSwitch{.bitrate = change.bitrate.value_or(0)};
  auto out = plan_bus_bitrate(std::move(link), *change.bitrate, may_change);
  if (!out || !out->follows()) return out;
  if (std::chrono::milliseconds(*change.delay_ms) < kLeastDelay)
    out->why_not = formatted("{} ms are too short for it: --activate 1s", *change.delay_ms);
  return out;
}

Result<LssBitrateOutcome> set_lss_bitrate(show::Desk& desk, const LssBitrateChange& change,
                                          BitrateSwitch& plan) {
  return LssBitrateRun(desk, change, plan).run();
}

}  // namespace servoctl::settings
