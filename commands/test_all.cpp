
#include "base/file.hpp"
#include "base/format.hpp"
#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "command/trial_options.hpp"
#include "trial/comm_trial.hpp"
#include "trial/io_trial.hpp"
#include "trial/motion_trials.hpp"
#include "trial/verdict.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::TestResult;

constexpr auto kTestAllParameters = with_motion_options(std::to_array<Parameter>({
    {.name = "speed", .help = "for `test jog`: 60rpm", .kind = Kind::value, .required = true},
    {.name = "--expect", .help = "inputs for `test io`; without it, no `test io`", .kind = Kind::text},
    {.name = "--for", .help = "how long in each direction (default 2s)", .kind = Kind::duration},
    {.name = "--tolerance", .help = "how far the speed may be off, in % (default 10)", .kind = Kind::number},
    {.name = "--stop-within", .help = "longest time to standstill (default 1s)", .kind = Kind::duration},
    {.name = "--no-home", .help = "skip `test home`", .kind = Kind::flag},
    {.name = "--repeat", .help = "homings (default 5)", .kind = Kind::number},
    {.name = "--spread", .help = "greatest spread of home (default 1)", .kind = Kind::number},
    kEncoderOption,
    kAccelerationOption,
    kJunitOption,
}));

/// All tests of one drive, in the order in which each rests on the one before.
class AllTests {
 public:
  AllTests(Context& context, const Arguments& arguments) : context_(&context), arguments_(&arguments) {}

  Result<report::Value> run() {
    auto request = motion_request(*context_, *arguments_);
    if (!request) return fail(request.error());
    request_ = std::move(*request);
    const auto node = request_->node;
    auto jog = parse_jog_test(*arguments_, arguments_->text("speed"));
    if (!jog) return fail(jog.error());
    const auto home = parse_home_test(*arguments_, {});
    if (!home) return fail(home.error());
    const auto inputs = trial::parse_inputs(*context_, arguments_->text("--expect"));
    if (!inputs) return fail(inputs.error());
    if (const auto possible = check_junit(); !possible) return fail(possible.error());
    if (const auto done = add(trial::test_communication(*context_, node, {})); !done)
      return fail(done.error());
    // A motor is not moved by way of a bus that has just failed, nor towards a switch that has.
    bool may_move = may_go_on("test comm");
    const bool heard = may_move;
    // Asked here and not before the command: a drive that does not answer has failed its first test.
    if (heard)
      if (const auto fits = context_->hold_family(context_->nodes, context_->profile, true); !fits)
        return fail(fits.error());
    // Nothing is begun that a limit would end half way.
    if (may_move)
      if (const auto possible = check(*jog, *home); !possible) {
        context_->errors.push_back(possible.error());
        may_move = false;
      }
    if (!inputs->empty() && may_move) {
      if (const auto done = add(trial::test_inputs(*context_, node, {*inputs})); !done)
        return fail(done.error());
      may_move = may_go_on("test io");
    }
    // What was found before is told even when a motion is refused, or not confirmed.
    if (may_move)
      if (const auto done = move(*jog, *home); !done) context_->errors.push_back(done.error());
    if (context_->dry_run) return report::Value(std::move(plans_));
    return trial::verdicts(*context_, verdict_options(*arguments_), results_);
  }

 private:
  /// Whether the last test leaves it to the motor to be moved; else it is told which one does not.
  bool may_go_on(std::string_view name) {
    if (results_.empty() || passed(results_.back())) return true;
    context_->notices.push_back(message("node {}: nothing was moved, because `{}` failed",
                                        node_name(request_->node), as_it_is(name)));
    return false;
  }

  Result<void> check_junit() const {
    if (!arguments_->has("--junit") || context_->dry_run) return {};
    return check_writable(std::string(arguments_->text("--junit")));
  }

  Result<void> add(Result<TestResult> result) {
    if (!result) return fail(result.error());
    results_.push_back(std::move(*result));
    return {};
  }

  Result<void> add(Result<trial::MotionTrial> done) {
    if (!done) return fail(done.error());
    if (!done->result) {
      plans_.push_back(std::move(done->plan));
      return {};
    }
    results_.push_back(std::move(*done->result));
    return {};
  }

  bool homes() const { return !arguments_->has("--no-home") && context_->profile->rules.motion.homing; }

  /// What the first question is to tell of the homing is put into `jog`.
  Result<void> check(trial::JogTrial& jog, const trial::HomeTrial& home) const {
    if (auto possible = trial::check_jog_test(*context_, *request_, jog); !possible || !homes())
      return possible;
    auto possible = trial::check_home_test(*context_, *request_, home);
    if (possible && !context_->dry_run) jog.then = std::move(*possible);
    if (possible) return {};
    auto error = possible.error();
    error.message = "`test home` cannot be run, so nothing is moved: " + error.message;
    error.hint += "; or add --no-home";
    return fail(std::move(error));
  }

  Result<void> move(const trial::JogTrial& jog, const trial::HomeTrial& home) {
    if (const auto done = add(trial::test_jog(*context_, *request_, jog)); !done) return done;
    if (!context_->dry_run && !passed(results_.back())) return {};
    if (!homes()) return {};
    return add(trial::test_home(*context_, *request_, home));
  }

  Context* context_;
  const Arguments* arguments_;
  std::optional<motion::MotionRequest> request_;
  std::vector<TestResult> results_;
  report::List plans_;
};

Result<void> check_left_out(const Arguments& arguments) {
  for (const auto* option : {"--repeat", "--spread"})
    if (arguments.has("--no-home") && arguments.has(option))
      return fail(Errc::usage, message("{} is for `test home`, which --no-home skips", option),
                  "leave one of them out");
  return {};
}

Result<void> check_test_all(Context& context, const Arguments& arguments) {
  if (const auto fits = check_left_out(arguments); !fits) return fits;
  if (const auto jog = parse_jog_test(arguments, arguments.text("speed")); !jog) return fail(jog.error());
  if (const auto home = parse_home_test(arguments, {}); !home) return fail(home.error());
  return check_motion_words(context, arguments, drive::Use::jog, {written_speed("speed")});
}

Result<report::Value> run_test_all(Context& context, const Arguments& arguments) {
  if (const auto fits = check_left_out(arguments); !fits) return fail(fits.error());
  return AllTests(context, arguments).run();
}

constexpr Example kTestAllExamples[] = {
    {"test all 60rpm -n 1 -d gsd600 --turn 131072 --limit 600rpm --window 5rev",
     "131072: take your motor's counts; homing at 600 rpm, 5 turns at most"},
    {"test all 60rpm --no-home --json -n 1 -d sv2", "without homing; the JSON is for `report --tests`"},
};

}  // namespace

extern const Command kTestAll;
const Command kTestAll{
    .path = "test all",
    .summary = "Test communication, inputs, both directions and homing, with a verdict",
    .details =
        "Runs `test comm`, `test io` if --expect names inputs, `test jog` and, if the family can home and "
        "--no-home is not given, `test home` with the drive's present method. If a limit or an option "
        "rules out any of them, nothing is moved at all. After a failure nothing more is moved. Each "
        "motion shows its preflight checks and asks, as it would alone; the first question names the homing as "
        "well. Without --window a homing that finds no switch goes on for 60 s. Exit code 1 if a test fails.",
    .parameters = kTestAllParameters,
    .examples = kTestAllExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .family = FamilyCheck::never,
    .run = run_test_all,
    .check = check_test_all,
};

}  // namespace servoctl::commands
