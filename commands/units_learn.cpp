#include <cmath>
#include <initializer_list>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "motion/kept_turn.hpp"
#include "session/identify.hpp"
#include "session/measure.hpp"
#include "show/drive_rules.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using motion::Learn;
using report::Record;
using report::Value;

constexpr Duration kShortest = std::chrono::seconds(2);
constexpr Duration kLongest = std::chrono::seconds(60);

constexpr Parameter kUnitsLearnParameters[] = {
    {.name = "--speed",
     .help = "motor speed: 15rpm to 30rpm (default 30rpm); the sign is the direction",
     .kind = Kind::value},
    {.name = "--for", .help = "measuring time (default 6s)", .kind = Kind::duration},
    {.name = "--nameplate",
     .help = "encoder counts per revolution on the nameplate, compared with the result",
     .kind = Kind::number},
    {.name = "--max-torque", .help = "stop above this torque", .kind = Kind::value},
    {.name = "--max-following-error", .help = "stop above this following error", .kind = Kind::value},
    {.name = "--window", .help = "stop when it has moved further than this", .kind = Kind::value},
    {.name = "--master-node", .help = "node-ID of servoctl for the watchdog", .kind = Kind::number},
    {.name = "--plot", .help = "plot the samples over time at the end", .kind = Kind::flag},
    kCsvOption,
};

Result<double> learning_speed(const Arguments& arguments) {
  if (!arguments.has("--speed")) return Learn{}.rpm;
  auto text = arguments.text("--speed");
  const auto unit = lower(text).rfind("rpm");
  if (unit != std::string::npos && unit + 3 == text.size()) text = text.substr(0, unit);
  const auto rpm = parse_real(text);
  if (rpm && std::abs(*rpm) >= motion::kLeastLearnRpm && std::abs(*rpm) <= motion::kMostLearnRpm) return *rpm;
  return fail(
      Errc::usage,
      message("--speed: '{}' is not 15rpm to 30rpm in either direction", as_it_is(arguments.text("--speed"))),
      "slower is too inaccurate, faster is not safe before the counts are known");
}

Result<std::optional<double>> nameplate_of(const Arguments& arguments) {
  if (!arguments.has("--nameplate")) return std::optional<double>();
  const auto counts = parse_integer(arguments.text("--nameplate"));
  if (counts && !counts->negative && counts->magnitude > 0)
    return std::optional(static_cast<double>(counts->magnitude));
  return fail(Errc::usage,
              message("--nameplate: '{}' is not a number of counts", as_it_is(arguments.text("--nameplate"))),
              "such as 131072 for 17 bits");
}

Result<Duration> length_of(const Arguments& arguments) {
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  if (!*length) return Learn{}.length;
  if (**length >= kShortest && **length <= kLongest) return **length;
  return fail(Errc::usage, "--for: the measuring time is 2 s to 60 s", "--for 6s");
}

/// What keeps the number from being measured: conditions of the rules that do not hold.
std::string unmet(Context& context, std::uint8_t node) {
  std::string out;
  const auto ways = context.profile->rules.units.find(drive::Measure::increments_per_turn);
  if (ways == context.profile->rules.units.end()) return out;
  for (const auto& way : ways->second) {
    if (!way.learned) continue;
    for (const auto& condition : way.when) {
      const auto present = context.session->upload(node, condition.object);
      if (present && load_le(*present) == condition.value) continue;
      const auto target = drive::target_at(context.profile, condition.object);
      const auto name = target.parameter != nullptr ? target.parameter->id : to_string(condition.object);
      out += (out.empty() ? "" : ", ") +
             (present ? formatted("{} is {}, not {}", name, load_le(*present), condition.value)
                      : formatted("{} cannot be read", name));
    }
  }
  return out;
}

tl::unexpected<Error> refused(std::uint8_t node, Message message, Message hint) {
  return fail(drive_error(Errc::refused, node, std::move(message), std::move(hint)));
}

/// Increments of 6064h in one of the counts that are measured. Errc::refused where there is nothing to
/// measure, or nothing to measure by.
Result<double> read_gear(Context& context, std::uint8_t node) {
  const session::MeasureQuestion question[] = {{node, drive::Measure::increments_per_turn, 1.0}};
  const auto known = session::read_measures(*context.session, *context.profile, question).front();
  if (known && known->learned && known->value > 0) return known->value;
  if (known) {
    const auto pending = motion::restart_note(*context.profile, *known->way);
    return refused(node,
                   message("its parameters already give {} increments per revolution{}: nothing to learn",
                           plain_number(known->value, 12), pending.empty() ? "" : " once they take effect"),
                   "`units show` lists which" + (pending.empty() ? "" : "; " + pending));
  }
  const auto why = unmet(context, node);
  return refused(node, "its present settings prevent the measurement" + (why.empty() ? why : ": " + why),
                 std::string(motion::kOtherWay));
}

Result<Learn> learn_of(Context& context, const Arguments& arguments, std::uint8_t node) {
  const auto& rules = context.profile->rules;
  if (rules.learn.speed.empty()) {
    const auto ways = rules.units.find(drive::Measure::increments_per_turn);
    const auto told = ways == rules.units.end() ? std::string() : show::ways_text(ways->second);
    return fail(Errc::refused,
                told.empty()
                    ? message("{} has no speed monitor to measure with", as_it_is(context.profile->family))
                    : message("{} reports the counts per revolution itself: {}",
                              as_it_is(context.profile->family), told),
                told.empty() ? std::string(motion::kOtherWay) : "`units show` reads them");
  }
  const auto monitor = drive::resolve(context.profile, rules.learn.speed);
  if (!monitor) return fail(monitor.error());
  const auto gear = read_gear(context, node);
  if (!gear) return fail(gear.error());
  const auto rpm = learning_speed(arguments);
  if (!rpm) return fail(rpm.error());
  const auto length = length_of(arguments);
  if (!length) return fail(length.error());
  Learn out;
  out.rpm = *rpm;
  out.length = *length;
  out.monitor = monitor->address;
  out.monitor_name = rules.learn.speed;
  out.least = rules.learn.least;
  out.gear = *gear;
  const auto nameplate = nameplate_of(arguments);
  if (!nameplate) return fail(nameplate.error());
  out.expected.told = *nameplate;
  out.expected.node = node;
  out.expected.disputed = monitor->is_contradicted("scale");
  return out;
}

/// Of the way that is measured.
std::string restart_note(const Context& context) {
  for (const auto& way : context.profile->rules.units.at(drive::Measure::increments_per_turn))
    if (way.learned) return motion::restart_note(*context.profile, way);
  return {};
}

Result<void> keep(Context& context, std::uint8_t node, const motion::LearnReport& done, double gear) {
  // What was measured holds for these settings of this drive.
  const auto now = read_gear(context, node);
  if (!now || *now != gear)
    return refused(node, "its gear was changed during the measurement: nothing is kept", "measure again");
  const auto identity = session::read_identity(*context.session, node);
  if (!identity) return fail(identity.error());
  motion::KeptTurn turn;
  turn.counts = static_cast<std::uint64_t>(std::llround(done.counts->counts));
  turn.measured = static_cast<std::uint64_t>(std::llround(done.measured->increments / gear));
  turn.uncertainty_ppm = static_cast<std::uint64_t>(std::llround(done.measured->uncertainty * 1e6));
  turn.reason = done.counts->reason;
  turn.time = utc_now_text();
  turn.family = context.profile->family;
  turn.identity = *identity;
  auto written = motion::TurnFile(context, node).write(turn);
  if (written) return written;
  auto error = written.error();
  error.message = message("the measured {} counts are not kept: {}", turn.counts, error.message);
  return fail(std::move(error));
}

void add_measurement(Value& answer, const motion::LearnReport& done, double gear, bool kept) {
  auto* record = std::get_if<Record>(&answer.data());
  if (record == nullptr) return;
  Record found;
  const auto add_unknown = [&](std::initializer_list<std::string_view> keys) {
    for (const auto key : keys) found.push_back({std::string(key), Value(), report::Show::json});
  };
  if (done.counts) {
    found.push_back(
        {"counts", std::llround(done.counts->counts), report::Show::everywhere, "counts per revolution"});
    found.push_back({"why", done.counts->reason});
  } else {
    add_unknown({"counts", "why"});
  }
  if (done.measured) {
    const auto& measured = *done.measured;
    found.push_back({"measured", std::llround(measured.increments / gear)});
    found.push_back({"uncertainty", parse_real(plain_number(measured.uncertainty * 100, 3)).value_or(0),
                     report::Show::everywhere, "uncertainty (± %)"});
    found.push_back({"gear", gear, report::Show::everywhere, "increments per count"});
    found.push_back({"rpm", parse_real(plain_number(measured.rpm, 4)).value_or(0)});
    found.push_back({"turns", parse_real(plain_number(measured.turns, 4)).value_or(0)});
    found.push_back({"looks", std::uint64_t{measured.looks}, report::Show::json});
  } else {
    add_unknown({"measured", "uncertainty", "gear", "rpm", "turns", "looks"});
  }
  found.push_back({"kept", kept});
  // Behind what was done, before how the drive was left.
  const auto at = std::min<std::size_t>(3, record->size());
  record->insert(record->begin() + static_cast<std::ptrdiff_t>(at), found.begin(), found.end());
}

Result<Value> run_units_learn(Context& context, const Arguments& arguments) {
  const auto request = motion_request(context, arguments);
  if (!request) return fail(request.error());
  const auto node = request->node;
  const auto learn = learn_of(context, arguments, node);
  if (!learn) return fail(learn.error());
  const motion::TurnFile file(context, node);
  if (file.path().empty())
    return fail(Errc::refused, "there is no folder to keep the result in", "set HOME or XDG_STATE_HOME");
  if (!context.dry_run)
    if (const auto possible = check_writable(file.path()); !possible) return fail(possible.error());
  motion::LearnReport done;
  bool moved = false;
  motion::MotionRun motion;
  motion.in_counts = true;
  motion.plan = [&](motion::Motion& m) {
    auto plan = motion::plan_learn(m, *learn);
    if (plan) plan->tell(restart_note(context));
    return plan;
  };
  motion.run = [&](motion::Motion& m, const motion::MotionPlan& plan) {
    done = motion::run_learn(m, *learn, plan);
    moved = true;
    return done.motion;
  };
  auto answer = motion::run_motion(context, *request, motion);
  if (!answer || !moved) return answer;
  bool kept = false;
  if (done.counts) {
    const auto written = keep(context, node, done, learn->gear);
    kept = written.has_value();
    if (!written) context.errors.push_back(written.error());
  }
  add_measurement(*answer, done, learn->gear, kept);
  return answer;
}

Result<void> check_units_learn(Context& context, const Arguments& arguments) {
  if (const auto rpm = learning_speed(arguments); !rpm) return fail(rpm.error());
  if (const auto length = length_of(arguments); !length) return fail(length.error());
  if (const auto nameplate = nameplate_of(arguments); !nameplate) return fail(nameplate.error());
  return check_motion_words(context, arguments, drive::Use::jog, {});
}

constexpr Example kUnitsLearnExamples[] = {
    {"units learn -n 1 -d gsd600", "about four turns at 30 rpm, after a question"},
    {"units learn --speed -15rpm --nameplate 131072 -n 1 -d gsd600",
     "slowly backwards, compared with the nameplate of the encoder"},
};

}  // namespace

extern const Command kUnitsLearn;
const Command kUnitsLearn{
    .path = "units learn",
    .summary = "Turn a motor slowly to measure its counts per revolution, and keep them",
    .details =
        "For drives that do not report it. Checks, asks, moves and ends as `jog` does: speeds up until the "
        "drive's own speed monitor shows 30 rpm, then 6 s at that speed, about 4 turns in all. The result "
        "is the change of 6064h divided by the integral of the monitor, without the gear 6091h; 606Ch must "
        "agree. It is refused if it may be more than 1 % off, or if the monitor shows nothing or does not "
        "match the position. The power of two within 1 % is taken, else a round decimal number (not where "
        "the manual prints two scales for the monitor: then --nameplate COUNTS is compared with the "
        "result). It is kept for this bus, node and identity (1000h, 1008h, 1018h) and used by every "
        "motion without --turn, with a notice; the drive's own parameters take precedence.",
    .parameters = kUnitsLearnParameters,
    .examples = kUnitsLearnExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_units_learn,
    .check = check_units_learn,
};

}  // namespace servoctl::commands
