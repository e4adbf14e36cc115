#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "base/format.hpp"
#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "drive/cia402.hpp"
#include "motion/left_energised.hpp"
#include "motion/motion_result.hpp"
#include "motion/motion_run.hpp"
#include "motion/operation_mode.hpp"
#include "motion/power.hpp"
#include "session/option_scope.hpp"
#include "show/planned_messages.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

/// What is wrong in a word of a batch file is reported before its first line is run.
Result<void> check_enable(Context& context, const Arguments& arguments) {
  const auto options = motion_options(context, arguments);
  return options ? Result<void>() : fail(options.error());
}

constexpr Parameter kEnableParameters[] = {kTurnOption, kPanelOption, kIgnoreRemoteOption};

using Items = std::vector<motion::PreflightItem>;

/// Up to "operation enabled" with harmless targets. On every other way out the drive is de-energised. `shown`
/// is what its preflight has shown.
Result<void> energise(Context& context, motion::Motion& motion, const Items& shown,
                      session::Rehearsal& rehearsal) {
  // Answers to other masters that came while a person was thinking are not for what is asked now.
  if (const auto heard = context.session->listen(); !heard) return heard;
  motion::MotionGuard guard(*context.session, motion.units(), motion.node());
  if (context.dry_run) guard.rehearse(rehearsal);
  guard.set_other_source(motion.other_source());
  if (const auto done = guard.learn_rpdos(); !done) return done;
  const bool starts_first = guard.needs_process_data();
  if (starts_first)
    if (const auto done = guard.start_node(); !done) return done;
  if (const auto done = guard.neutral_targets(); !done) return done;
  if (!starts_first)
    if (const auto done = guard.start_node(); !done) return done;
  if (starts_first && !context.dry_run) {
    const auto fine = motion::look_in_op(*context.session, motion.units(), motion.node(), context.chinese,
                                         shown, motion::ask_again(context, motion.node()), motion.request());
    if (!fine) return fine;
  }
  if (const auto done = guard.enable(); !done) return done;
  return guard.release();
}

/// On CAN it is left to itself, with whatever watchdog it has.
motion::PreflightItem watchdog_of(const Context& context, const motion::Motion& motion) {
  using Weight = motion::PreflightItem::Weight;
  if (context.session->network().carries(session::LifeSign::Kind::process_data))
    return motion::watchdog_item(motion.watchdog());
  return {
      Weight::caution, "watchdog",
      "none by servoctl, which does not supervise it; `watchdog` shows what the drive itself does when its master "
      "is lost"};
}

/// Of one node of the line, before any is enabled; what was shown goes into `shown`.
Result<void> look_at(Context& context, motion::Motion& motion, Items& shown) {
  if (const auto ready = motion.prepare(); !ready) return fail(ready.error());
  // Where it stays energised after servoctl has gone nothing can watch servoctl.
  if (context.session->network().carries(session::LifeSign::Kind::process_data))
    if (const auto found = motion.find_watchdog(); !found) return found;
  if (const auto possible = motion.intend({drive::Use::enable}); !possible) return possible;
  auto items = motion.look_at_drive(context.chinese);
  if (!items) return fail(items.error());
  shown = *items;
  items->push_back(watchdog_of(context, motion));
  context.tell(motion::preflight_text(*items, context.chinese));
  return motion::check_preflight(*items, motion.node());
}

Result<void> ask(Context& context, motion::Motion& motion) {
  if (context.dry_run) return {};
  const auto mode = motion::read_mode(*context.session, motion.node());
  if (!mode) return fail(mode.error());
  return context.confirm(formatted(
      "Energise node {} in mode {} and leave it energised? It will not be supervised, and the motor may move.",
      motion.node(), motion::mode_text(*context.profile, *mode, context.chinese)));
}

/// The nodes of a line on their way: all are looked at and asked for before the first is enabled, and what
/// keeps one from it keeps all.
class Enabling {
 public:
  explicit Enabling(Context& context) : context_(&context) {}

  /// Errc::usage for options that say nothing.
  Result<void> begin(const Arguments& arguments) {
    for (const auto node : context_->nodes) {
      auto options = motion_options(*context_, arguments);
      if (!options) return fail(options.error());
      motions_.push_back(std::make_unique<motion::Motion>(*context_->session, *context_->profile, node,
                                                          std::move(*options)));
    }
    return {};
  }

  void run(session::Rehearsal& rehearsal) {
    if (!each([this](motion::Motion& motion) { return look_at(*context_, motion, shown_[motion.node()]); }))
      return;
    confirmed_ = each([this](motion::Motion& motion) { return ask(*context_, motion); });
    if (!confirmed_) return;
    if (!each([&](motion::Motion& motion) { return enable(motion, rehearsal); })) take_back();
  }

  /// With the states read now, also behind Ctrl-C: they say what has power.
  report::Table table() const {
    const session::Deaf deaf(*context_->session);
    report::Table out;
    out.columns = {{"node"}, {"state"}, {"energised", "", Show::json}, {"result"}, {"error", "", Show::json}};
    for (const auto& motion : motions_) {
      const auto node = motion->node();
      const auto state = motion::Power(*context_->session, *context_->profile, node).state();
      const bool is_it = failed_ == node;
      out.rows.push_back({node, state ? Value(drive::name(*state)) : Value(),
                          state ? Value(drive::is_energised(*state)) : Value(),
                          is_it && confirmed_ ? "failed" : result_of(node),
                          is_it ? show::error_record(*error_) : Value()});
    }
    return out;
  }

 private:
  template <class Step>
  bool each(const Step& step) {
    for (const auto& motion : motions_)
      if (const auto done = step(*motion); !done) {
        failed_ = motion->node();
        error_ = done.error();
        context_->errors.push_back(done.error());
        return false;
      }
    return true;
  }

  Result<void> enable(motion::Motion& motion, session::Rehearsal& rehearsal) {
    begun_.insert(motion.node());
    if (const auto done = energise(*context_, motion, shown_[motion.node()], rehearsal);
        !done || context_->dry_run)
      return done;
    const auto state = motion::Power(*context_->session, *context_->profile, motion.node()).state();
    if (!state || *state == drive::DriveState::operation_enabled) return {};
    return fail(drive_error(Errc::negative, motion.node(),
                            message("was enabled but did not stay so: it is in {}", drive::name(*state)),
                            "see `status` and `fault show`"));
  }

  /// A line that fails leaves no motor with the power that it gave.
  void take_back() {
    if (context_->dry_run) return;
    std::set<std::uint8_t> nodes;
    for (const auto node : begun_)
      if (context_->session->energised().contains(node)) nodes.insert(node);
    for (const auto& [node, done, in_fault] : motion::de_energise(*context_->session, nodes)) {
      if (in_fault) {
        context_->errors.push_back(motion::ended_in_fault(node));
        taken_back_.insert(node);
        continue;
      }
      if (done) {
        context_->notices.push_back(message(
            "node {} had been enabled by this line; it has been stopped and disabled", node_name(node)));
        taken_back_.insert(node);
        continue;
      }
      auto error = done.error();
      error.message = motion::power_warning(node, error.message);
      context_->errors.push_back(std::move(error));
    }
  }

  std::string_view result_of(std::uint8_t node) const {
    if (taken_back_.count(node) != 0) return "disabled again";
    if (failed_ && begun_.count(node) != 0) return "failed";
    if (failed_) return "not enabled";
    const bool ends = context_->disables_at_end || context_->session->network().must_go_on();
    return ends ? "ENERGISED while servoctl runs" : "ENERGISED, and stays so";
  }

  Context* context_;
  std::vector<std::unique_ptr<motion::Motion>> motions_;
  std::map<std::uint8_t, Items> shown_;  ///< By node.
  std::set<std::uint8_t> begun_;
  std::set<std::uint8_t> taken_back_;
  bool confirmed_ = true;  ///< Whoever was asked and did not say yes has not failed.
  std::optional<std::uint8_t> failed_;
  std::optional<Error> error_;
};

Result<Value> run_enable(Context& context, const Arguments& arguments) {
  Enabling enabling(context);
  if (const auto begun = enabling.begin(arguments); !begun) return fail(begun.error());
  session::Rehearsal rehearsal;
  enabling.run(rehearsal);
  if (context.dry_run) return show::planned_messages(context, rehearsal.messages());
  auto table = enabling.table();
  return Value(std::move(table));
}

constexpr Example kEnableExamples[] = {
    {"enable -n 1 -d gsd600", "energise it at standstill, after the checks and a question"},
    {"enable -n 1 -d gsd600 --dry-run", "the checks alone: what would stand against it"},
};

}  // namespace

extern const Command kEnable;
const Command kEnable{
    .path = "enable",
    .summary = "Energise a drive and leave it enabled",
    .details =
        "Shows the preflight checks, asks, sets the targets so that nothing moves (60FFh and 6071h to 0, "
        "607Ah to the actual position), and goes to \"operation enabled\" by controlwords 06h, 07h, 0Fh, "
        "waiting for each state. Of several nodes all are looked at before the first is enabled: where one is "
        "refused none is, and where one fails those that were enabled before it are disabled again. "
        "The drive stays energised when a single command, or lines of a file or a pipe that ended without an "
        "error, are done: `disable` de-energises it. A prompt that ends, lines that end with an error, and a "
        "lost terminal stop and disable it. Over "
        "EtherCAT it stays so only while servoctl exchanges process data with it: a single command holds it until "
        "Ctrl-C, and then stops and disables it. "
        "`jog` and `move` enable and disable by themselves.",
    .parameters = kEnableParameters,
    .examples = kEnableExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_enable,
    .check = check_enable,
};

}  // namespace servoctl::commands
