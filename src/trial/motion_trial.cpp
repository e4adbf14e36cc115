#include "trial/motion_trial.hpp"

#include "motion/motion_result.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {

Result<MotionTrial> run_test_motion(
    show::Desk& desk, const motion::MotionRequest& request,
    const std::function<Result<motion::MotionPlan>(motion::Motion&)>& plan,
    const std::function<motion::MotionReport(motion::Motion&, const motion::MotionPlan&)>& run,
    const std::function<report::TestResult(const motion::MotionPlan&, const motion::MotionReport&)>& judge) {
  MotionTrial out;
  motion::MotionRun motion;
  motion.plan = plan;
  motion.run = [&](motion::Motion& m, const motion::MotionPlan& planned) {
    const auto begin = m.session().now();
    auto done = run(m, planned);
    out.result = judge(planned, done);
    out.result->node = m.node();
    out.result->seconds = seconds_of(m.session().now() - begin);
    out.result->samples.series = done.series;
    return done;
  };
  auto answer = motion::run_motion(desk, request, motion);
  if (!answer) return fail(answer.error());
  if (!out.result) out.plan = std::move(*answer);
  return out;
}

void judge_motion(const show::Desk& desk, const motion::MotionReport& done, report::TestResult& out) {
  const auto add = [&](std::string id, std::string name, bool good, std::string note) {
    const auto yes = say(desk, "yes");
    auto criterion = report::holds(std::move(id), std::move(name), good, good ? yes : say(desk, "NO"), yes);
    criterion.note = std::move(note);
    out.criteria.push_back(std::move(criterion));
  };
  add("completed", say(desk, "motion completed"), done.outcome.has_value(),
      done.outcome ? std::string() : done.outcome.error().message.text());
  add("left_without_power", say(desk, "left de-energised"), done.end.verified,
      motion::end_text(done.end, done.watchdog));
}

}  // namespace servoctl::trial
