#include "settings/bitrate_switch.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "drive/bitrate.hpp"
#include "session/scan.hpp"
#include "session/stretch.hpp"

namespace servoctl::settings {
namespace {

using drive::bitrate_text;
using session::Identity;

/// Until the NMT command has left the controller, and before any drive has started again: 2 ms of it at
/// 50 kbit/s.
constexpr Duration kCommandLeaves = std::chrono::milliseconds(20);
/// From an NMT reset to the boot-up message.
constexpr Duration kBooting = std::chrono::seconds(10);
constexpr Duration kLookAgain = std::chrono::seconds(2);

using drive::NmtRules;

bool restarts_over_bus(const BitrateSwitch& plan) { return plan.restart != NmtRules::Restart::power_cycle; }

/// What is enough for all of them: power for one is power for all, and a reset of a node resets its
/// communication as well (CiA 301, 7.3.2.2.1).
NmtRules::Restart restart_of(std::span<const AddressChange> changes) {
  auto out = NmtRules::Restart::reset_communication;
  for (const auto& change : changes) {
    if (change.restart == NmtRules::Restart::power_cycle) return change.restart;
    if (change.restart == NmtRules::Restart::reset_node) out = change.restart;
  }
  return out;
}

/// The one that all are of; empty where they are of several.
std::string family_of(std::span<const AddressChange> changes) {
  const auto& first = changes.front().profile->family;
  const bool one = std::ranges::all_of(
      changes, [&](const AddressChange& change) { return change.profile->family == first; });
  return one ? first : std::string();
}

/// All drives and the interface, between two bitrates.
class SwitchRun {
 public:
  SwitchRun(show::Desk& desk, BitrateSwitch& plan, std::span<const AddressChange> changes,
            const AddressOptions& options)
      : desk_(&desk), session_(desk.session), plan_(&plan), options_(&options) {
    for (auto change : changes) {
      change.bitrate = plan.bitrate;
      before_.push_back(change.node);
      after_.push_back(change.to);
      changes_.push_back(std::move(change));
    }
    over_bus_ = restarts_over_bus(plan);
  }

  void run(std::span<AddressOutcome> outcomes) {
    const auto done = move();
    if (!done) {
      for (auto& outcome : outcomes) outcome.end = end_;
      outcomes.front().error = done.error();
      return;
    }
    for (std::size_t i = 0; i < changes_.size(); ++i)
      outcomes[i] = find_again(*desk_, changes_[i], std::move(outcomes[i]));
  }

 private:
  Result<void> move() {
    deadline_ = session_->now() + (over_bus_ ? kBooting : options_->patience);
    const session::Stretch stretch(*session_, deadline_, session::Stretch::End::at_latest);
    if (const auto gone = over_bus_ ? reset_all() : wait_until_off(); !gone) return gone;
    for (const auto node : before_) session::forget_node(*session_, node);
    for (const auto node : after_) session::forget_node(*session_, node);
    boots_ = boots();
    end_ = AddressEnd::failed;
    if (const auto set = take_to(*session_, *plan_, plan_->bitrate); !set)
      return fail(left_alone(set.error()));
    const auto found = wait_until_on();
    if (!found) return fail(somewhere(found.error()));
    return *found > 0 ? Result<void>() : look_at_old();
  }

  Result<void> reset_all() {
    if (const auto sent = session::restart_node(*session_, 0, plan_->restart); !sent) return sent;
    const auto left = session_->wait([] { return false; }, session_->now() + kCommandLeaves);
    // The command has gone out: nobody can stop between the two bitrates any more.
    return left || left.error().code == Errc::interrupted ? Result<void>() : fail(left.error());
  }

  Result<void> wait_until_off() {
    desk_->tell(
        formatted("switch all drives of the bus off and on again now: they are waited for at {} for {}\n",
                  bitrate_text(plan_->bitrate), to_string(options_->patience)));
    while (session_->now() < deadline_) {
      const auto there = session::scan(*session_, before_);
      if (!there && there.error().code == Errc::interrupted) return fail(there.error());
      // Where nobody is left, nobody acknowledges either.
      if (!there || there->empty()) return {};
      const auto waited = session_->wait([] { return false; }, session_->now() + std::chrono::seconds(1));
      if (!waited && waited.error().code == Errc::interrupted) return fail(waited.error());
      if (!waited) return {};
    }
    return fail(drive_error(
        Errc::negative, before_.front(),
        message("still answers: the drives were not switched off, and {} stays at {}",
                as_it_is(plan_->link->name()), session::settings_text(plan_->before)),
        "what was written holds from their next start; the same line waits again, a plan with --resume"));
  }

  std::vector<std::uint32_t> boots() const {
    std::vector<std::uint32_t> out;
    for (const auto node : after_) out.push_back(session_->watch().boots(node));
    return out;
  }

  /// How many are there. Where no one has started yet there is nobody who would acknowledge a question.
  Result<std::size_t> wait_until_on() {
    const auto booted = [&] {
      const auto now = boots();
      std::size_t out = 0;
      for (std::size_t i = 0; i < now.size(); ++i) out += now[i] > boots_[i] ? 1U : 0U;
      return out;
    };
    std::size_t found = 0;
    bool looked = false;
    for (bool over = false; !over && found < after_.size();) {
      const auto until = std::min(deadline_, session_->now() + kLookAgain);
      const auto waited = session_->wait([&] { return !looked && booted() == after_.size(); }, until);
      over = session_->now() >= deadline_;
      if (waited && !over_bus_ && !over && booted() == 0) continue;
      looked = true;
      const auto there =
          waited ? session::scan(*session_, after_) : Result<std::vector<Identity>>(fail(waited.error()));
      if (there) {
        found = there->size();
      } else if (over || there.error().code == Errc::interrupted) {
        return fail(there.error());
      } else {
        // Nobody has started yet who would acknowledge.
        (void)session_->network().recover(until);
      }
    }
    return found;
  }

  /// None took the bitrate: perhaps none was restarted.
  Result<void> look_at_old() {
    const auto name = plan_->link->name();
    auto error = drive_error(
        Errc::timeout, after_.front(), message("no drive answers at {}", bitrate_text(plan_->bitrate)),
        message("{} has it now; switch the drives off and on, then `scan`", as_it_is(name)));
    std::uint8_t who = 0;
    const auto back = take_back(*session_, *plan_, [&] {
      const auto there = session::scan(*session_, before_);
      if (there && !there->empty()) who = there->front().node;
      return who != 0;
    });
    if (!back) error.hint = "`bus status` shows the interface";
    if (!back || !*back) return fail(std::move(error));
    end_ = AddressEnd::awaits_restart;
    const auto old = old_bitrate_text(*plan_);
    return fail(drive_error(
        Errc::negative, who,
        message("still answers at {}: the restart did not put its new bitrate in force; {} is at {} again",
                old, as_it_is(name), old),
        over_bus_ ? "add --wait 5min: it asks for switching off and on" : "switch the drives off and on"));
  }

  Error left_alone(Error error) const {
    error.message = message("the drives start at {} now, and {} could not follow: {}",
                            bitrate_text(plan_->bitrate), as_it_is(plan_->link->name()), error.message);
    return error;
  }

  Error somewhere(Error error) const {
    error.message = message("{} is at {} now; where the drives are was not seen: {}",
                            as_it_is(plan_->link->name()), bitrate_text(plan_->bitrate), error.message);
    if (error.hint.empty()) error.hint = "`scan` shows who answers";
    return error;
  }

  show::Desk* desk_;
  session::Session* session_;
  BitrateSwitch* plan_;
  const AddressOptions* options_;
  std::vector<AddressChange> changes_;
  std::vector<std::uint8_t> before_;
  std::vector<std::uint8_t> after_;
  std::vector<std::uint32_t> boots_;  ///< Of `after_`, when they went.
  bool over_bus_ = false;
  TimePoint deadline_{};
  AddressEnd end_ = AddressEnd::awaits_restart;
};

}  // namespace

Result<BitrateSwitch> plan_switch(show::Desk& desk, std::unique_ptr<can::LinkControl> link,
                                  std::span<const AddressChange> changes, std::uint32_t bitrate,
                                  const AddressOptions& options, const std::optional<bool>& may_change) {
  if (changes.empty()) return BitrateSwitch{.bitrate = bitrate};
  auto out = plan_bus_bitrate(std::move(link), bitrate, may_change);
  if (!out) return out;
  out->restart = restart_of(changes);
  if (!out->follows()) return out;
  if (!restarts_over_bus(*out) && options.patience == Duration::zero()) {
    out->why_not = "the drives have to be switched off and on: with --wait 5min they are waited for";
    return out;
  }
  std::vector<std::uint8_t> drives;
  for (const auto& change : changes) drives.push_back(change.node);
  const auto others = session::nodes_beside(*desk.session, drives, {.guards = !desk.dry_run});
  if (!others) return fail(others.error());
  if (!others->empty())
    out->why_not =
        formatted("node{} {} would be left at {}: all on the bus have to be named, and to answer",
                  others->size() == 1 ? "" : "s", fmt::join(*others, ", "), old_bitrate_text(*out));
  return out;
}

std::string switch_text(const BitrateSwitch& plan) {
  return formatted("{}, and {} goes to {} (from {})",
                   restarts_over_bus(plan)
                       ? formatted("then all are restarted at once (NMT {})", drive::name(plan.restart))
                       : std::string("then all have to be switched off and on"),
                   plan.link->name(), bitrate_text(plan.bitrate), session::settings_text(plan.before));
}

std::string switch_commands(const BitrateSwitch& plan) {
  const auto& name = plan.link->name();
  return formatted(
      "{}, `{}`, `{}`",
      restarts_over_bus(plan) ? formatted("{} (NMT {} to all)", session::restart_frame(0, plan.restart),
                                          drive::name(plan.restart))
                              : std::string("when the drives are off"),
      can::ip_command(name, {.up = false}), can::ip_command(name, {.up = true, .bitrate = plan.bitrate}));
}

void tell_bitrate_by_hand(show::Desk& desk, const BitrateSwitch& plan,
                          std::span<const AddressChange> changes) {
  if (plan.link != nullptr && !plan.why_not.empty())
    desk.notices.push_back(message("{} is left alone: {}", as_it_is(plan.link->name()), plan.why_not));
  for (const auto& line : bitrate_steps(desk.session->url(), plan.bitrate, family_of(changes)))
    desk.notices.push_back(line);
}

void follow_bitrate(show::Desk& desk, BitrateSwitch& plan, std::span<const AddressChange> changes,
                    std::span<AddressOutcome> outcomes, const AddressOptions& options) {
  SwitchRun(desk, plan, changes, options).run(outcomes);
}

}  // namespace servoctl::settings
