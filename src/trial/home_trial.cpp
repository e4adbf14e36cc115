#include <algorithm>
#include <cmath>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "trial/figures.hpp"
#include "trial/motion_trial.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {
namespace {

using motion::Signal;
using report::Record;
using report::TestResult;

/// Where one homing ended.
struct Found {
  std::optional<double> position;  ///< 6064h at rest.
  std::optional<double> encoder;   ///< What the encoder counts less 6064h: home as the encoder sees it.
  double seconds = 0;
};

class Homings {
 public:
  Homings(const show::Desk& desk, const HomeTrial& test) : desk_(&desk), test_(&test) {
    home_.method = test.method;
  }

  const motion::Home& home() const { return home_; }

  /// As often as wanted, until one fails.
  motion::MotionReport run(motion::Motion& motion, const motion::MotionPlan& plan) {
    for (;;) {
      const auto begin = motion.session().now();
      auto done = motion::run_home(motion, home_, plan);
      if (!done.outcome || !done.end.verified) return done;
      found_.push_back(look(motion, done, motion.session().now() - begin));
      if (found_.size() == test_->repeat) return done;
    }
  }

  TestResult judged(const motion::MotionReport& done) const {
    TestResult out;
    out.test = "home";
    out.criteria.push_back(report::at_least("found", say("successful homings"),
                                            static_cast<double>(found_.size()), test_->repeat));
    judge_motion(*desk_, done, out);
    std::string unit;
    for (const auto& series : done.series)
      if (series.name == motion::name(Signal::position)) unit = series.unit;
    judge_spread("spread", say("spread of the final position"), &Found::position, unit, out);
    judge_spread("encoder_spread", say("spread of home against the encoder"), &Found::encoder, unit, out);
    out.figures.push_back(homings_figure(*desk_, rows(), unit));
    return out;
  }

 private:
  std::string say(std::string_view english) const { return trial::say(*desk_, english); }

  Found look(motion::Motion& motion, const motion::MotionReport& done, Duration time) const {
    Found out;
    out.seconds = seconds_of(time);
    if (!done.samples.empty()) out.position = done.samples.back()[Signal::position];
    const auto& units = motion.units();
    const auto counter = units.object(motion.rules().encoder);
    if (!out.position || !counter || !units.has(*counter) ||
        units.unit(*counter) != units.unit(objects::kPositionActual))
      return out;
    const auto counts = motion.session().upload(motion.node(), *counter);
    const auto now = motion.session().upload(motion.node(), objects::kPositionActual);
    if (!counts || !now) return out;
    const auto encoder = units.physical(*counter, *counts);
    const auto position = units.physical(objects::kPositionActual, *now);
    if (encoder && position) out.encoder = encoder->value - position->value;
    return out;
  }

  void judge_spread(std::string id, std::string name, std::optional<double> Found::*member,
                    const std::string& unit, TestResult& out) const {
    std::vector<double> values;
    for (const auto& found : found_)
      if (found.*member) values.push_back(*(found.*member));
    if (values.size() < 2) {
      out.criteria.push_back(report::skipped(
          std::move(id), std::move(name),
          found_.size() < 2 ? say("fewer than two homings")
                            : say("not available in the position unit; --encoder COUNTS may help")));
      return;
    }
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    out.criteria.push_back(
        report::at_most(std::move(id), std::move(name), *greatest - *least, test_->spread, unit));
  }

  std::vector<report::List> rows() const {
    std::vector<report::List> out;
    for (const auto& found : found_) {
      const auto number = [](std::optional<double> value) {
        return value ? report::Value(*value) : report::Value();
      };
      out.push_back({out.size() + 1, found.seconds, number(found.position), number(found.encoder)});
    }
    return out;
  }

  const show::Desk* desk_;
  const HomeTrial* test_;
  motion::Home home_;
  std::vector<Found> found_;
};

std::string homing_text(motion::Motion& motion, const motion::MotionPlan& plan, const HomeTrial& test) {
  auto out = formatted("{}, {} times, for {} at most each", plan.summary, test.repeat,
                       servoctl::to_string(plan.longest));
  const auto& units = motion.units();
  if (const auto window = motion.limits().travel)
    out += formatted(", {} at most", units.words(*window, units.unit(objects::kPositionActual)));
  return out;
}

}  // namespace

Result<std::string> check_home_test(const show::Desk& desk, const motion::MotionRequest& request,
                                    const HomeTrial& test) {
  motion::Home home;
  home.method = test.method;
  std::string text;
  const auto possible = motion::check_motion(desk, request, [&](motion::Motion& motion) {
    auto plan = motion::plan_home(motion, home);
    if (plan) text = homing_text(motion, *plan, test);
    return plan;
  });
  if (!possible) return fail(possible.error());
  return text;
}

Result<MotionTrial> test_home(show::Desk& desk, const motion::MotionRequest& request, const HomeTrial& test) {
  Homings homings(desk, test);
  const auto plan = [&](motion::Motion& motion) {
    auto planned = motion::plan_home(motion, homings.home());
    if (planned) planned->summary += formatted(", {} times", test.repeat);
    return planned;
  };
  return run_test_motion(
      desk, request, plan,
      [&](motion::Motion& motion, const motion::MotionPlan& planned) { return homings.run(motion, planned); },
      [&](const motion::MotionPlan&, const motion::MotionReport& done) { return homings.judged(done); });
}

}  // namespace servoctl::trial
