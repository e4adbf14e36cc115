#include <fmt/format.h>

#include "commands/command.hpp"
#include "commands/left_energised.hpp"
#include "commands/motion_options.hpp"
#include "commands/motion_result.hpp"
#include "commands/planned_messages.hpp"
#include "commands/records.hpp"
#include "drive/cia402.hpp"
#include "session/operation_mode.hpp"

namespace servoctl::commands {
namespace {

using report::Show;
using report::Value;

constexpr Parameter kParameters[] = {kTurnOption};

/// Up to "operation enabled" with harmless targets. On every other way out the drive is de-energised.
Result<void> energise(Context& context, session::Motion& motion, session::Rehearsal& rehearsal) {
  // Answers to other masters that came while a person was thinking are not for what is asked now.
  if (const auto heard = context.session->listen(); !heard) return heard;
  session::MotionGuard guard(*context.session, motion.units(), motion.node());
  if (context.dry_run) guard.rehearse(rehearsal);
  if (const auto done = guard.neutral_targets(); !done) return done;
  if (const auto done = guard.start_node(); !done) return done;
  if (const auto done = guard.enable(); !done) return done;
  return guard.release();
}

Result<void> enable_one(Context& context, session::Motion& motion, session::Rehearsal& rehearsal) {
  if (const auto ready = motion.prepare(); !ready) return tl::unexpected<Error>(ready.error());
  // It stays energised after servoctl has gone, so nothing can watch servoctl.
  const auto items = session::preflight(*context.session, motion.units(), motion.node(), {}, context.chinese);
  if (!items) return tl::unexpected<Error>(items.error());
  context.tell(preflight_text(*items));
  if (const auto possible = session::check_preflight(*items, motion.node()); !possible)
    return tl::unexpected<Error>(possible.error());
  if (context.dry_run) return energise(context, motion, rehearsal);
  const auto mode = session::read_mode(*context.session, motion.node());
  if (!mode) return tl::unexpected<Error>(mode.error());
  const auto question = fmt::format(
      "Energise node {} and leave it so, in mode {}? Nothing will watch over it, and the motor may move.",
      motion.node(), session::mode_text(*context.profile, *mode, context.chinese));
  if (const auto answer = context.confirm(question); !answer) return tl::unexpected<Error>(answer.error());
  return energise(context, motion, rehearsal);
}

/// What would be sent to all nodes, up to the first that is refused.
Result<Value> planned(Context& context, const Arguments& arguments) {
  session::Rehearsal rehearsal;
  for (const auto node : context.nodes) {
    auto options = motion_options(context, arguments);
    if (!options) return tl::unexpected<Error>(options.error());
    session::Motion motion(*context.session, *context.profile, node, std::move(*options));
    if (const auto done = enable_one(context, motion, rehearsal); !done) {
      context.errors.push_back(done.error());
      break;
    }
  }
  return planned_messages(context, rehearsal.messages());
}

Result<Value> run(Context& context, const Arguments& arguments) {
  if (context.dry_run) return planned(context, arguments);
  session::Rehearsal unused;
  report::Table table;
  table.columns = {{"node"}, {"state"}, {"energised", "", Show::json}, {"result"}, {"error", "", Show::json}};
  for (const auto node : context.nodes) {
    auto options = motion_options(context, arguments);
    if (!options) return tl::unexpected<Error>(options.error());
    session::Motion motion(*context.session, *context.profile, node, std::move(*options));
    auto done = enable_one(context, motion, unused);
    session::Power power(*context.session, *context.profile, node);
    const auto state = power.state();
    if (done && state && *state != drive::DriveState::operation_enabled)
      done = fail(session::drive_error(
          Errc::negative, node,
          fmt::format("was enabled and did not stay so: it is in {}", drive::name(*state)),
          "`status` and `fault show` tell more; `disable` it before anything else"));
    if (!done) context.errors.push_back(done.error());
    table.rows.push_back({node, state ? Value(drive::name(*state)) : Value(),
                          state ? Value(drive::is_energised(*state)) : Value(),
                          done ? "ENERGISED, and stays so" : "failed",
                          done ? Value() : error_record(done.error())});
    if (done) context.notices.push_back(energised_notice(node));
    if (!done) break;
  }
  return Value(std::move(table));
}

}  // namespace

extern const Command kEnable;
const Command kEnable{
    .path = "enable",
    .summary = "Energise a drive and leave it enabled",
    .details =
        "Shows what there is to know before, asks, sets the targets so that nothing moves (60FFh and 6071h "
        "to 0, 607Ah "
        "to where it stands), and goes to \"operation enabled\" by controlwords 06h, 07h, 0Fh, waiting in "
        "every state. "
        "The drive stays energised when servoctl ends: `disable` takes the power away. `jog` and `move` "
        "enable and "
        "disable by themselves.",
    .parameters = kParameters,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run,
};

}  // namespace servoctl::commands
