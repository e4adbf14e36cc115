#include <fmt/format.h>

#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "drive/cia402.hpp"
#include "motion/left_energised.hpp"
#include "motion/motion_result.hpp"
#include "motion/operation_mode.hpp"
#include "show/planned_messages.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

constexpr Parameter kEnableParameters[] = {kTurnOption};

/// Up to "operation enabled" with harmless targets. On every other way out the drive is de-energised.
Result<void> energise(Context& context, motion::Motion& motion, session::Rehearsal& rehearsal) {
  // Answers to other masters that came while a person was thinking are not for what is asked now.
  if (const auto heard = context.session->listen(); !heard) return heard;
  motion::MotionGuard guard(*context.session, motion.units(), motion.node());
  if (context.dry_run) guard.rehearse(rehearsal);
  const bool starts_first = guard.needs_process_data();
  if (starts_first)
    if (const auto done = guard.start_node(); !done) return done;
  if (const auto done = guard.neutral_targets(); !done) return done;
  if (!starts_first)
    if (const auto done = guard.start_node(); !done) return done;
  if (const auto done = guard.enable(); !done) return done;
  return guard.release();
}

Result<void> enable_one(Context& context, motion::Motion& motion, session::Rehearsal& rehearsal) {
  if (const auto ready = motion.prepare(); !ready) return fail(ready.error());
  // Where it stays energised after servoctl has gone nothing can watch servoctl.
  const auto watchdog = context.session->network().carries(session::LifeSign::Kind::process_data)
                            ? motion.watchdog()
                            : motion::WatchdogPlan{};
  const auto items =
      motion::preflight(*context.session, motion.units(), motion.node(), watchdog, context.chinese);
  if (!items) return fail(items.error());
  context.tell(motion::preflight_text(*items));
  if (const auto possible = motion::check_preflight(*items, motion.node()); !possible)
    return fail(possible.error());
  if (context.dry_run) return energise(context, motion, rehearsal);
  const auto mode = motion::read_mode(*context.session, motion.node());
  if (!mode) return fail(mode.error());
  const auto question = fmt::format(
      "Energise node {} in mode {} and leave it energised? It will not be supervised, and the motor may move.",
      motion.node(), motion::mode_text(*context.profile, *mode, context.chinese));
  if (const auto answer = context.confirm(question); !answer) return fail(answer.error());
  return energise(context, motion, rehearsal);
}

std::string_view result_text(const Context& context) {
  return context.session->network().must_go_on() ? "ENERGISED while servoctl runs"
                                                 : "ENERGISED, and stays so";
}

/// What would be sent to all nodes, up to the first that is refused.
Result<Value> planned_enable(Context& context, const Arguments& arguments) {
  session::Rehearsal rehearsal;
  for (const auto node : context.nodes) {
    auto options = motion_options(context, arguments);
    if (!options) return fail(options.error());
    motion::Motion motion(*context.session, *context.profile, node, std::move(*options));
    if (const auto done = enable_one(context, motion, rehearsal); !done) {
      context.errors.push_back(done.error());
      break;
    }
  }
  return show::planned_messages(context, rehearsal.messages());
}

Result<Value> run_enable(Context& context, const Arguments& arguments) {
  if (context.dry_run) return planned_enable(context, arguments);
  session::Rehearsal unused;
  report::Table table;
  table.columns = {{"node"}, {"state"}, {"energised", "", Show::json}, {"result"}, {"error", "", Show::json}};
  for (const auto node : context.nodes) {
    auto options = motion_options(context, arguments);
    if (!options) return fail(options.error());
    motion::Motion motion(*context.session, *context.profile, node, std::move(*options));
    auto done = enable_one(context, motion, unused);
    motion::Power power(*context.session, *context.profile, node);
    const auto state = power.state();
    if (done && state && *state != drive::DriveState::operation_enabled)
      done =
          fail(drive_error(Errc::negative, node,
                           fmt::format("was enabled but did not stay so: it is in {}", drive::name(*state)),
                           "see `status` and `fault show`; `disable` it before anything else"));
    if (!done) context.errors.push_back(done.error());
    table.rows.push_back({node, state ? Value(drive::name(*state)) : Value(),
                          state ? Value(drive::is_energised(*state)) : Value(),
                          done ? result_text(context) : "failed",
                          done ? Value() : show::error_record(done.error())});
    if (done) context.notices.push_back(motion::energised_notice(*context.session, node));
    if (!done) break;
  }
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
        "waiting for each state. The drive stays energised when a single command, or lines that ended without an error, are "
        "done: `disable` de-energises it. Lines that end with an error, and a lost terminal, stop and disable it. Over "
        "EtherCAT it stays so only while servoctl exchanges process data with it: a single command holds it until "
        "Ctrl-C, and then stops and disables it. "
        "`jog` and `move` enable and disable by themselves.",
    .parameters = kEnableParameters,
    .examples = kEnableExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_enable,
};

}  // namespace servoctl::commands
