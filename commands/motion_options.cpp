#include "commands/motion_options.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/number.hpp"
#include "canopen/cob_id.hpp"
#include "commands/kept_turn.hpp"
#include "commands/motion_result.hpp"
#include "commands/planned_messages.hpp"
#include "drive/standard_objects.hpp"
#include "session/operation_mode.hpp"

namespace servoctl::commands {
namespace {

using report::Record;
using report::Show;
using report::Value;

/// A line of text so often; `-o jsonl` has every sample.
constexpr Duration kLinePeriod = std::chrono::milliseconds(250);

/// Shows the samples while they come.
class Display {
 public:
  Display(Context& context, const session::Motion& motion) : context_(&context), motion_(&motion) {}

  void operator()(const session::MotionSample& sample) {
    if (!begin_) begin_ = sample.time;
    const bool due = !last_line_ || sample.time - *last_line_ >= kLinePeriod;
    if (due) last_line_ = sample.time;
    context_->emit(sample_record(sample, *begin_),
                   due ? sample_line(sample, *begin_, motion_->units()) : std::string());
  }

 private:
  Context* context_;
  const session::Motion* motion_;
  std::optional<TimePoint> begin_;
  std::optional<TimePoint> last_line_;
};

report::List planned_step(const Context& context, const session::Motion& motion,
                          const session::PlannedMessage& message) {
  if (!message.write)
    return {message.step, "", Value(), report::text_or_null(message.when), frame_text(message)};
  const auto object = message.write->object;
  const auto& data = *message.write->data;
  const auto value = motion.units().physical(object, data);
  std::string text = value ? fmt::format("{} {}", number_text(value->value), value->unit) : to_hex(data);
  const bool of_communication = object.index >= 0x1000 && object.index < 0x2000;
  if (object == objects::kControlword || of_communication)
    text = fmt::format("0x{:0{}X}", load_le(data), 2 * data.size());
  if (object == objects::kModeOfOperation)
    text = session::mode_text(*context.profile, static_cast<std::int8_t>(load_le(data)), context.chinese);
  return {message.step, to_string(object), text, report::text_or_null(message.when), frame_text(message)};
}

/// What would be sent, in order, if the drive follows.
Result<Value> planned(const Context& context, session::Motion& motion, const session::MotionPlan& plan,
                      const std::vector<session::PreflightItem>& items) {
  const auto messages = motion.rehearse(plan);
  if (!messages) return tl::unexpected<Error>(messages.error());
  report::Table steps;
  steps.columns = {{"step"}, {"object"}, {"value"}, {"when"}, {"frame"}};
  for (const auto& message : *messages) steps.rows.push_back(planned_step(context, motion, message));
  return Value(Record{{"node", motion.node()},
                      {"motion", plan.summary},
                      {"watchdog", session::to_string(motion.watchdog()), Show::json},
                      {"preflight", preflight_table(items)},
                      {"steps", std::move(steps)}});
}

Result<void> ask(Context& context, std::uint8_t node, const session::MotionPlan& plan,
                 const std::vector<session::PreflightItem>& items, const std::vector<std::string>& notes) {
  if (context.tell) {
    context.tell(preflight_text(items));
    for (const auto& note : notes) context.tell(fmt::format("note     {}\n", note));
  }
  return context.confirm(
      fmt::format("The motor of node {} will move: {}. Is the machine clear?", node, plan.summary));
}

std::optional<std::uint64_t> number(const Arguments& arguments, std::string_view name) {
  const auto value = parse_integer(arguments.text(name));
  return value && !value->negative ? std::optional(value->magnitude) : std::nullopt;
}

}  // namespace

Result<std::uint8_t> one_node(const Context& context) {
  if (context.nodes.size() == 1 && context.nodes.front() != 0) return context.nodes.front();
  return fail(Errc::usage, "one motor at a time: this command takes one node", "-n 1");
}

Result<session::MotionOptions> motion_options(const Context& context, const Arguments& arguments) {
  session::MotionOptions out;
  out.speed_limit = arguments.text("--limit");
  out.acceleration = arguments.text("--accel");
  out.max_torque = arguments.text("--max-torque");
  out.max_following_error = arguments.text("--max-following-error");
  out.window = arguments.text("--window");
  out.unheard = context.output_lost;
  for (const auto& [name, place] : {std::pair("--turn", &out.turn), std::pair("--encoder", &out.encoder)}) {
    if (!arguments.has(name)) continue;
    const auto counts = number(arguments, name);
    if (!counts || *counts == 0)
      return fail(Errc::usage, fmt::format("'{}' is no number of counts", arguments.text(name)),
                  "such as 131072 for 17 bits");
    *place = static_cast<double>(*counts);
  }
  if (!arguments.has("--master-node")) return out;
  const auto id = number(arguments, "--master-node");
  if (!id || *id < canopen::kFirstNode || *id > canopen::kLastNode)
    return fail(Errc::usage, fmt::format("'{}' is no node-ID", arguments.text("--master-node")),
                "write 1..127");
  out.producer = static_cast<std::uint8_t>(*id);
  return out;
}

Result<void> check_motion(const Context& context, const Arguments& arguments,
                          const std::function<Result<session::MotionPlan>(session::Motion&)>& plan) {
  const auto node = one_node(context);
  if (!node) return tl::unexpected<Error>(node.error());
  auto options = motion_options(context, arguments);
  if (!options) return tl::unexpected<Error>(options.error());
  if (!options->turn) options->learned = find_turn(context, *node).counts;
  session::Motion motion(*context.session, *context.profile, *node, std::move(*options));
  auto ready = motion.prepare();
  if (ready)
    if (const auto planned = plan(motion); !planned) ready = tl::unexpected<Error>(planned.error());
  const bool of_the_question =
      !ready && (ready.error().code == Errc::usage || ready.error().code == Errc::refused);
  return of_the_question ? ready : Result<void>{};
}

Result<Value> run_motion(Context& context, const Arguments& arguments, const MotionRun& run) {
  const auto node = one_node(context);
  if (!node) return tl::unexpected<Error>(node.error());
  auto options = motion_options(context, arguments);
  if (!options) return tl::unexpected<Error>(options.error());
  const std::string csv(arguments.text("--csv"));
  if (!csv.empty() && !context.dry_run)
    if (const auto possible = check_writable(csv); !possible) return tl::unexpected<Error>(possible.error());
  if (run.in_counts) options->turn.reset();
  const auto known = options->turn || run.in_counts ? KnownTurn{} : find_turn(context, *node);
  options->learned = known.counts;
  std::function<void(const session::MotionSample&)> display;
  options->on_sample = [&display](const session::MotionSample& sample) { display(sample); };
  session::Motion motion(*context.session, *context.profile, *node, std::move(*options));
  display = Display(context, motion);
  if (const auto ready = motion.prepare(); !ready) return tl::unexpected<Error>(ready.error());
  auto notes = turn_notes(motion.units(), known);
  for (const auto& note : notes) context.notices.push_back(fmt::format("node {}: {}", *node, note));
  const auto plan = run.plan(motion);
  if (!plan) return tl::unexpected<Error>(plan.error());
  const auto items = motion.look(context.chinese);
  if (!items) return tl::unexpected<Error>(items.error());
  for (const auto& note : plan->notes) context.notices.push_back(fmt::format("node {}: {}", *node, note));
  notes.insert(notes.end(), plan->notes.begin(), plan->notes.end());
  auto possible = session::check_preflight(*items, *node);
  if (possible) possible = session::check_mode(*context.session, *context.profile, *node, plan->mode);
  if (context.dry_run && possible) return planned(context, motion, *plan, *items);
  if (context.dry_run) {
    context.errors.push_back(possible.error());
    return Value(Record{{"node", *node}, {"motion", plan->summary}, {"preflight", preflight_table(*items)}});
  }
  if (!possible) return tl::unexpected<Error>(possible.error());
  if (const auto answer = ask(context, *node, *plan, *items, notes); !answer)
    return tl::unexpected<Error>(answer.error());
  const auto done = run.run(motion, *plan);
  if (!done.begun && !done.outcome) return tl::unexpected<Error>(done.outcome.error());
  auto result = motion_result(context, *node, *plan, *items, done, arguments.has("--plot"));
  if (!csv.empty())
    if (const auto written = write_csv(csv, done.samples, motion.units()); !written)
      context.errors.push_back(written.error());
  return result;
}

}  // namespace servoctl::commands
