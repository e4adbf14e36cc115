#include "motion/motion_run.hpp"

#include "base/duration.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/standard_objects.hpp"
#include "motion/kept_turn.hpp"
#include "motion/motion_result.hpp"
#include "motion/operation_mode.hpp"
#include "show/planned_messages.hpp"

namespace servoctl::motion {
namespace {

using report::Record;
using report::Show;
using report::Value;

/// A line of text so often; `-o jsonl` has every sample.
constexpr Duration kLinePeriod = std::chrono::milliseconds(250);

/// Shows the samples while they come.
class Display {
 public:
  Display(show::Desk& desk, const Motion& motion) : desk_(&desk), motion_(&motion) {}

  void operator()(const MotionSample& sample) {
    if (!begin_) begin_ = sample.time;
    const bool due = !last_line_ || sample.time - *last_line_ >= kLinePeriod;
    if (due) last_line_ = sample.time;
    desk_->emit(sample_record(sample, *begin_),
                due ? sample_line(sample, *begin_, motion_->units()) : std::string());
  }

 private:
  show::Desk* desk_;
  const Motion* motion_;
  std::optional<TimePoint> begin_;
  std::optional<TimePoint> last_line_;
};

report::List planned_step(const show::Desk& desk, const Motion& motion,
                          const session::PlannedMessage& message) {
  const auto& network = desk.session->network();
  const bool frames = show::is_sent_as_frames(desk);
  const auto frame = frames ? Value(show::frame_text(message)) : Value();
  if (!message.write && frames) return {message.step, "", Value(), report::text_or_null(message.when), frame};
  if (message.state)
    return {message.step, network.state_title(), network.state_word(*message.state),
            report::text_or_null(message.when), frame};
  if (message.life_sign)
    return {message.step, "watchdog", servoctl::to_string(message.life_sign->period), Value(), frame};
  const auto object = message.write->object;
  const auto& data = *message.write->data;
  const auto value = motion.units().physical(object, data);
  std::string text = value ? formatted("{} {}", number_text(value->value), value->unit) : to_hex(data);
  const bool of_communication = object.index >= 0x1000 && object.index < 0x2000;
  if (object == objects::kControlword || of_communication)
    text = formatted("0x{:0{}X}", load_le(data), 2 * data.size());
  if (object == objects::kModeOfOperation)
    text = mode_text(*desk.profile, static_cast<std::int8_t>(load_le(data)), desk.chinese);
  return {message.step, to_string(object), text, report::text_or_null(message.when), frame};
}

/// What would be sent, in order, if the drive follows.
Result<Value> planned(const show::Desk& desk, Motion& motion, const MotionPlan& plan,
                      const std::vector<PreflightItem>& items) {
  const auto messages = motion.rehearse(plan);
  if (!messages) return fail(messages.error());
  report::Table steps;
  steps.columns = {{"step"}, {"object"}, {"value"}, {"when"}, {"frame"}};
  for (const auto& message : *messages) steps.rows.push_back(planned_step(desk, motion, message));
  return Value(Record{{"node", motion.node()},
                      {"motion", plan.summary},
                      {"watchdog", to_string(motion.watchdog()), Show::json},
                      {"preflight", preflight_table(items)},
                      {"steps", std::move(steps)}});
}

/// Of a motion that is refused.
Value without_steps(std::uint8_t node, const MotionPlan& plan, const std::vector<PreflightItem>& items) {
  return Value(Record{{"node", node},
                      {"motion", plan.summary},
                      {"watchdog", Value(), Show::json},
                      {"preflight", preflight_table(items)},
                      {"steps", Value(), Show::json}});
}

Result<void> ask(show::Desk& desk, std::uint8_t node, const MotionPlan& plan,
                 const std::vector<PreflightItem>& items, const std::vector<std::string>& notes) {
  desk.tell(preflight_text(items, desk.chinese));
  const auto column = weight_column(PreflightItem::Weight::note, desk.chinese);
  for (const auto& note : notes) desk.tell(formatted("{}{}\n", column, note));
  return desk.confirm(
      formatted("The motor of node {} will move: {}. Is the machine clear?", node, plan.summary));
}

void take(const KnownTurn& known, MotionOptions& options) {
  options.learned = known.counts;
  options.supposed_turn = known.told_earlier;
}

}  // namespace

AskAgain ask_again(show::Desk& desk, std::uint8_t node) {
  return [&desk, node](const std::vector<PreflightItem>& unseen) {
    desk.tell(preflight_text(unseen, desk.chinese));
    return desk.confirm(formatted("Node {} reports this in OP, and did not report it before. Go on?", node));
  };
}

Result<void> check_motion(const show::Desk& desk, const MotionRequest& request,
                          const std::function<Result<MotionPlan>(Motion&)>& plan) {
  auto options = request.options;
  if (!options.turn) take(find_turn(desk, request.node), options);
  Motion motion(*desk.session, *desk.profile, request.node, std::move(options));
  auto ready = motion.prepare();
  if (ready)
    if (const auto planned = plan(motion); !planned) ready = fail(planned.error());
  const bool of_the_question =
      !ready && (ready.error().code == Errc::usage || ready.error().code == Errc::refused);
  return of_the_question ? ready : Result<void>{};
}

Result<Value> run_motion(show::Desk& desk, const MotionRequest& request, const MotionRun& run) {
  const auto node = request.node;
  const auto& csv = request.csv;
  auto options = request.options;
  options.ask_again = ask_again(desk, node);
  if (!csv.empty() && !desk.dry_run)
    if (const auto possible = check_writable(csv); !possible) return fail(possible.error());
  if (run.in_counts) options.turn.reset();
  const auto known = options.turn || run.in_counts ? KnownTurn{} : find_turn(desk, node);
  take(known, options);
  options.rehearsal = desk.dry_run;
  std::function<void(const MotionSample&)> display;
  options.on_sample = [&display](const MotionSample& sample) { display(sample); };
  Motion motion(*desk.session, *desk.profile, node, std::move(options));
  display = Display(desk, motion);
  if (const auto ready = motion.prepare(); !ready) return fail(ready.error());
  auto notes = turn_notes(motion.units(), known);
  for (const auto& note : notes) desk.notices.push_back(message("node {}: {}", node_name(node), note));
  const auto plan = run.plan(motion);
  if (!plan) return fail(plan.error());
  const auto items = motion.look(desk.chinese);
  if (!items) return fail(items.error());
  for (const auto& note : plan->notes) desk.notices.push_back(message("node {}: {}", node_name(node), note));
  notes.insert(notes.end(), plan->notes.begin(), plan->notes.end());
  auto possible = check_preflight(*items, node);
  if (possible) possible = check_mode(*desk.session, *desk.profile, node, plan->mode);
  if (desk.dry_run && possible) return planned(desk, motion, *plan, *items);
  if (desk.dry_run) {
    desk.errors.push_back(possible.error());
    return without_steps(node, *plan, *items);
  }
  if (!possible) return fail(possible.error());
  if (const auto answer = ask(desk, node, *plan, *items, notes); !answer) return fail(answer.error());
  const auto done = run.run(motion, *plan);
  if (!done.begun && !done.outcome) return fail(done.outcome.error());
  const auto written = csv.empty() ? Result<void>() : write_csv(csv, done.samples, motion.units());
  auto result = motion_result(desk, node, *plan, *items, done, request.plot);
  if (!written) desk.errors.push_back(written.error());
  return result;
}

}  // namespace servoctl::motion
