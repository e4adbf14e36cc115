#include <algorithm>
#include <cmath>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "session/stretch.hpp"
#include "trial/motion_trial.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {
namespace {

using motion::HoldKey;
using motion::MotionSample;
using motion::Signal;
using report::TestResult;

/// The motor rests so long between the two directions.
constexpr Duration kRest = std::chrono::milliseconds(1500);
/// A motor that follows does not fall behind by more than this part of its way.
constexpr double kMostGrowth = 0.01;
constexpr double kStandstillPart = 0.02;
constexpr double kStandstillRpm = 3;

/// Holds one arrow key, none, and then the other, on the clock of the bus.
class Timetable {
 public:
  explicit Timetable(Duration length) : length_(length) {}

  HoldKey key(TimePoint now) {
    if (begin_ == TimePoint{}) begin_ = now;
    const auto time = now - begin_;
    const auto next = time < length_               ? HoldKey::plus
                      : time < length_ + kRest     ? HoldKey::none
                      : time < 2 * length_ + kRest ? HoldKey::minus
                                                   : HoldKey::stop;
    if (next != key_) changes_.push_back(now);
    key_ = next;
    return next;
  }

  /// When each direction began, and when its end was commanded; fewer where it did not come so far.
  struct Phase {
    TimePoint begin;
    TimePoint end;
  };
  std::optional<Phase> phase(std::size_t number) const {
    if (changes_.size() < 2 * number + 2) return std::nullopt;
    return Phase{changes_[2 * number], changes_[2 * number + 1]};
  }
  Duration length() const { return length_; }
  Duration whole() const { return 2 * length_ + kRest; }

 private:
  Duration length_;
  TimePoint begin_{};
  HoldKey key_ = HoldKey::none;
  std::vector<TimePoint> changes_;
};

/// One direction, judged.
class Direction {
 public:
  Direction(const show::Desk& desk, const JogTrial& test, const motion::MotionPlan& plan,
            const motion::MotionReport& done, Timetable::Phase phase, bool forward, TestResult& out)
      : desk_(&desk), test_(&test), plan_(&plan), done_(&done), phase_(phase), forward_(forward), out_(&out) {
    // Until the middle it may still speed up.
    const auto middle = phase.begin + (phase.end - phase.begin) / 2;
    for (const auto& sample : done.samples) {
      if (sample.time > phase.begin && sample.time <= phase.end) turning_.push_back(&sample);
      if (sample.time >= middle && sample.time <= phase.end) steady_.push_back(&sample);
    }
  }

  void judge(Duration until_next) {
    judge_direction();
    judge_speed();
    judge_following_error();
    judge_stop(phase_.end + until_next);
  }

 private:
  std::string id(std::string_view name) const {
    return formatted("{}_{}", name, forward_ ? "forward" : "backward");
  }
  std::string title(std::string_view english) const {
    return forward_ ? say(*desk_, formatted("forward: {}", english))
                    : say(*desk_, formatted("backward: {}", english));
  }
  /// More digits than the sensors have say nothing.
  static double rounded(double number) { return parse_real(formatted("{:.4g}", number)).value_or(number); }
  double commanded() const { return forward_ ? plan_->value : -plan_->value; }
  std::string unit(Signal signal) const {
    for (const auto& series : done_->series)
      if (series.name == motion::name(signal)) return series.unit;
    return {};
  }
  void skip(std::string_view name, std::string title_text) {
    out_->criteria.push_back(
        report::skipped(id(name), std::move(title_text), say(*desk_, "not reported by the drive")));
  }

  /// The change of a quantity from the first to the last of these samples that have it.
  static std::optional<double> change(const std::vector<const MotionSample*>& samples, Signal signal) {
    std::optional<double> first;
    std::optional<double> last;
    for (const auto* sample : samples) {
      const auto value = (*sample)[signal];
      if (!value) continue;
      if (!first) first = value;
      last = value;
    }
    return first && last ? std::optional(*last - *first) : std::nullopt;
  }

  void judge_direction() {
    auto name = title("travel in commanded direction");
    const auto way = change(turning_, Signal::position);
    if (!way) return skip("direction", std::move(name));
    const double along = commanded() < 0 ? -*way : *way;
    auto criterion =
        report::at_least(id("direction"), std::move(name), rounded(along), 0, unit(Signal::position));
    // Standing still is no direction.
    if (along == 0) criterion.verdict = report::Verdict::failed;
    out_->criteria.push_back(std::move(criterion));
  }

  void judge_speed() {
    auto name = title("speed deviation");
    double worst = -1;
    for (const auto* sample : steady_)
      if (const auto speed = (*sample)[Signal::velocity])
        worst = std::max(worst, std::abs(*speed - commanded()) / std::abs(commanded()) * 100);
    if (worst < 0 || unit(Signal::velocity) != plan_->unit) return skip("speed", std::move(name));
    out_->criteria.push_back(
        report::at_most(id("speed"), std::move(name), rounded(worst), test_->tolerance, "%"));
  }

  void judge_following_error() {
    auto name = title("growth of the following error");
    const auto growth = change(steady_, Signal::following_error);
    const auto way = change(steady_, Signal::position);
    if (!growth || !way || unit(Signal::following_error) != unit(Signal::position))
      return skip("following_error", std::move(name));
    out_->criteria.push_back(report::at_most(id("following_error"), std::move(name),
                                             rounded(std::abs(*growth)),
                                             rounded(kMostGrowth * std::abs(*way)), unit(Signal::position)));
  }

  void judge_stop(TimePoint end) {
    auto name = title("time to standstill");
    const double still =
        std::max(plan_->unit == "rpm" ? kStandstillRpm : 0, std::abs(plan_->value) * kStandstillPart);
    const MotionSample* moved = nullptr;
    const MotionSample* stood = nullptr;
    for (const auto& sample : done_->samples) {
      const auto speed = sample[Signal::velocity];
      if (!speed || sample.time < phase_.end || sample.time >= end) continue;
      if (std::abs(*speed) > still) {
        moved = &sample;
        stood = nullptr;
      } else if (stood == nullptr) {
        stood = &sample;
      }
    }
    // One that did not come to rest moved to the end of what was seen.
    const auto* last = stood != nullptr ? stood : moved;
    if (last == nullptr) return skip("stop", std::move(name));
    auto criterion =
        report::at_most(id("stop"), std::move(name), rounded(milliseconds_of(last->time - phase_.end)),
                        milliseconds_of(test_->longest_stop), "ms");
    if (stood == nullptr) criterion.verdict = report::Verdict::failed;
    out_->criteria.push_back(std::move(criterion));
  }

  const show::Desk* desk_;
  const JogTrial* test_;
  const motion::MotionPlan* plan_;
  const motion::MotionReport* done_;
  Timetable::Phase phase_;
  bool forward_;
  TestResult* out_;
  std::vector<const MotionSample*> turning_;
  std::vector<const MotionSample*> steady_;
};

TestResult judged(const show::Desk& desk, const JogTrial& test, const Timetable& timetable,
                  const motion::MotionPlan& plan, const motion::MotionReport& done) {
  TestResult out;
  out.test = "jog";
  judge_motion(desk, done, out);
  for (const bool forward : {true, false})
    if (const auto phase = timetable.phase(forward ? 0 : 1))
      Direction(desk, test, plan, done, *phase, forward, out).judge(forward ? kRest : std::chrono::hours(1));
  return out;
}

}  // namespace

Result<void> check_jog_test(const show::Desk& desk, const motion::MotionRequest& request,
                            const JogTrial& test) {
  motion::Jog jog;
  jog.speed = test.speed;
  return motion::check_motion(desk, request,
                              [&](motion::Motion& motion) { return motion::plan_jog(motion, jog); });
}

Result<MotionTrial> test_jog(show::Desk& desk, const motion::MotionRequest& request, const JogTrial& test) {
  Timetable timetable(test.length);
  motion::Jog jog;
  jog.speed = test.speed;
  const auto plan = [&](motion::Motion& motion) {
    auto planned = motion::plan_jog(motion, jog);
    if (planned)
      planned->summary =
          formatted("turn at {} {} for {}, then back{}{}", number_text(planned->value), planned->unit,
                    to_string(test.length),
                    test.then.empty() ? "" : "; behind that, after a second question, ", test.then);
    if (const auto back = planned ? motion.units().bytes(objects::kTargetVelocity, -planned->value)
                                  : std::optional<Bytes>()) {
      const auto rest = planned->moving.back();
      planned->moving.emplace_back(objects::kTargetVelocity, *back);
      planned->moving.push_back(rest);
    }
    return planned;
  };
  const auto run = [&](motion::Motion& motion, const motion::MotionPlan& planned) {
    jog.keys = [&] { return timetable.key(motion.session().now()); };
    const auto end = motion.session().now() + timetable.whole();
    const session::Stretch stretch(motion.session(), end);
    return motion::run_jog(motion, jog, planned);
  };
  return run_test_motion(desk, request, plan, run,
                         [&](const motion::MotionPlan& planned, const motion::MotionReport& done) {
                           return judged(desk, test, timetable, planned, done);
                         });
}

}  // namespace servoctl::trial
