
#include "base/format.hpp"
#include "base/number.hpp"
#include "command/command.hpp"
#include "command/motion_options.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr auto kJogParameters = with_motion_options(std::to_array<Parameter>({
    {.name = "speed",
     .help = "60rpm, -1.5rev/s; the sign is the direction",
     .kind = Kind::value,
     .required = true},
    {.name = "--for", .help = "how long", .kind = Kind::duration},
    {.name = "--turns", .help = "how many motor revolutions", .kind = Kind::number},
    {.name = "--until-key",
     .help = "while an arrow key is held; any other key, or 5 s without one, ends it (default on a terminal)",
     .kind = Kind::flag},
    kAccelerationOption,
    kCsvOption,
}));

/// Turns the repetitions of a held key into "held" and "let go". Keyboards begin to repeat after up to 0.7 s,
/// and then do it at least ten times a second.
class HeldKey {
  using Keys = command::Keys;

 public:
  HeldKey(std::unique_ptr<command::Keys> keys, session::Session& session)
      : keys_(std::move(keys)), session_(&session) {}

  motion::HoldKey operator()() {
    for (auto key = keys_->take(); key != Keys::Key::none; key = keys_->take()) {
      const bool plus = key == Keys::Key::right || key == Keys::Key::up;
      const bool minus = key == Keys::Key::left || key == Keys::Key::down;
      if (!plus && !minus) return motion::HoldKey::stop;
      const auto now_held = plus ? motion::HoldKey::plus : motion::HoldKey::minus;
      repeats_ = now_held == held_;
      held_ = now_held;
      pressed_ = session_->now();
    }
    if (session_->now() - pressed_ > (repeats_ ? kRepeat : kFirstRepeat)) held_ = motion::HoldKey::none;
    return held_;
  }

 private:
  static constexpr Duration kFirstRepeat = std::chrono::milliseconds(700);
  static constexpr Duration kRepeat = std::chrono::milliseconds(200);

  std::unique_ptr<command::Keys> keys_;
  session::Session* session_;
  motion::HoldKey held_ = motion::HoldKey::none;
  bool repeats_ = false;
  TimePoint pressed_{};
};

Result<motion::Jog> parse_jog(const Arguments& arguments) {
  motion::Jog jog;
  jog.speed = arguments.text("speed");
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  jog.length = *length;
  if (arguments.has("--turns")) {
    jog.turns = parse_real(arguments.text("--turns"));
    if (!jog.turns || *jog.turns <= 0)
      return fail(Errc::usage, message("'{}' is not a number of turns", as_it_is(arguments.text("--turns"))),
                  "write 3 or 0.5; the sign of the speed is the direction");
  }
  if (int{jog.length.has_value()} + int{jog.turns.has_value()} + int{arguments.has("--until-key")} > 1)
    return fail(Errc::usage, "--for, --turns and --until-key exclude each other; give one");
  return jog;
}

Result<report::Value> run_jog(Context& context, const Arguments& arguments) {
  auto jog = parse_jog(arguments);
  if (!jog) return fail(jog.error());
  const bool by_key = !jog->length && !jog->turns;
  const auto missing = fail(Errc::usage, "how long?", "add --for 2s or --turns 3; key jog needs a terminal");
  motion::MotionRun motion;
  motion.plan = [&](motion::Motion& m) { return motion::plan_jog(m, *jog); };
  motion.run = [&](motion::Motion& m, const motion::MotionPlan& plan) {
    if (by_key) {
      auto keys = context.front_end->open_keys();
      if (keys == nullptr) return m.finish(missing);
      context.tell(
          "hold right or up to turn, left or down to turn back; any other key, or 5 s without one, ends it\n");
      auto held = std::make_shared<HeldKey>(std::move(keys), m.session());
      jog->keys = [held] { return (*held)(); };
    }
    auto done = motion::run_jog(m, *jog, plan);
    jog->keys = {};
    return done;
  };
  if (by_key && !context.dry_run &&
      (context.front_end == nullptr || context.front_end->open_keys() == nullptr))
    return missing;
  const auto request = motion_request(context, arguments);
  if (!request) return fail(request.error());
  return motion::run_motion(context, *request, motion);
}

Result<void> check_jog(Context& context, const Arguments& arguments) {
  if (const auto jog = parse_jog(arguments); !jog) return fail(jog.error());
  return check_motion_words(context, arguments, drive::Use::jog, {written_speed("speed")});
}

constexpr Example kJogExamples[] = {
    {"jog 60rpm --for 2s -n 1 -d gsd600 --turn 131072",
     "131072 counts a turn: take your motor's, a wrong number is a wrong speed"},
    {"jog -30rpm --turns 3 -n 1 -d sv2 --max-torque 30%", "three turns backwards, stopped above 30 % torque"},
    {"jog 400rpm --for 1s --limit 500rpm -n 1 -d sv2 --plot --csv jog.csv",
     "faster than the safe default, with the samples"},
};

}  // namespace

extern const Command kJog;
const Command kJog{
    .path = "jog",
    .summary = "Turn a motor at a speed, for a time, some turns, or while a key is held",
    .details =
        "Checks the drive and shows the result, asks, then enables the drive in its velocity mode, turns, "
        "stops and disables it, and restores everything it changed, also after Ctrl-C; over a connection that was lost "
        "once it is back, and where it does not come back it says so. --limit is needed above 300 rpm, or above the "
        "rated speed if that is lower. If the counts per turn are not known, the limit is calculated with the fewest of the "
        "family; if the family states none, --limit is always needed. Ramps take 0.5 s by default. It stops at once if the drive sends an emergency, does not answer, turns "
        "the wrong way or not at all, or exceeds a limit given; also if the drive's own speed monitor, where the family's "
        "data name one, shows 1.5 times the speed that was asked for, and 60 rpm more: then --turn is wrong. A drive "
        "with a heartbeat consumer (1016h) is set to watch servoctl meanwhile, with a consumer time of 0.5 s; the check "
        "says what it then does, and where that is assumed. Position, speed and torque are shown during the motion; "
        "-o jsonl has every sample.",
    .parameters = kJogParameters,
    .examples = kJogExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::moves,
    .run = run_jog,
    .check = check_jog,
};

}  // namespace servoctl::commands
