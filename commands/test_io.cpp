#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "base/text.hpp"
#include "commands/reading.hpp"
#include "commands/verdict.hpp"

namespace servoctl::commands {
namespace {

using report::Criterion;
using report::Record;
using report::Show;
using report::TestResult;
using report::Value;

constexpr ObjectAddress kInputs{0x60FD, 0};
constexpr unsigned kBits = 32;
constexpr Duration kEvery = std::chrono::milliseconds(10);
constexpr Duration kLength = std::chrono::seconds(30);

constexpr Parameter kParameters[] = {
    {.name = "--expect",
     .help = "inputs that must be seen at 0 and at 1: negative-limit, positive-limit, home, bit16, …",
     .kind = Kind::text},
    {.name = "--for", .help = "longest wait for them (default 30s)", .kind = Kind::duration},
    kJunitOption,
};

/// Negative limit, positive limit, home (CiA 402-2, 60FDh).
constexpr std::array<unsigned, 3> kFunctionBits{0, 1, 2};
constexpr std::array<std::string_view, 3> kNames{"negative-limit", "positive-limit", "home"};
constexpr std::array<std::string_view, 3> kNamesZh{"负限位", "正限位", "原点"};

std::string id_of(unsigned bit) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kFunctionBits[i] == bit) return std::string(kNames[i]);
  return fmt::format("bit{}", bit);
}

std::string name_of(const Context& context, unsigned bit) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kFunctionBits[i] == bit) return say(context, kNames[i], kNamesZh[i]);
  return say(context, fmt::format("bit{}", bit), fmt::format("位 {}", bit));
}

Result<unsigned> parse_input(std::string_view word) {
  std::vector<std::string> words;
  for (unsigned bit = 0; bit < kBits; ++bit) {
    if (equals_nocase(word, id_of(bit)) || equals_nocase(word, fmt::format("bit{}", bit))) return bit;
    words.push_back(id_of(bit));
  }
  auto hint = did_you_mean(word, words);
  return fail(
      Errc::usage, fmt::format("'{}' is no input", word),
      hint.empty() ? "there are negative-limit, positive-limit, home, and bit0 to bit31 of 60FDh" : hint);
}

Result<std::vector<unsigned>> expected_inputs(const Arguments& arguments) {
  std::vector<unsigned> out;
  for (const auto word : split(arguments.text("--expect"), ',')) {
    const auto bit = parse_input(trim(word));
    if (!bit) return tl::unexpected<Error>(bit.error());
    if (std::find(out.begin(), out.end(), *bit) == out.end()) out.push_back(*bit);
  }
  if (out.empty() && arguments.has("--expect"))
    return fail(Errc::usage, "--expect names no input", "write --expect positive-limit,home");
  return out;
}

/// Watches the inputs of one drive while somebody actuates them.
class InputTest {
 public:
  InputTest(Context& context, std::uint8_t node, std::vector<unsigned> expected)
      : context_(&context), session_(context.session), node_(node), expected_(std::move(expected)) {}

  Result<TestResult> run(Duration length) {
    const auto begin = session_->now();
    const auto end = begin + length;
    std::optional<std::uint32_t> before;
    while (session_->now() < end && !is_complete()) {
      const auto levels = read();
      if (!levels && levels.error().code == Errc::interrupted) break;
      if (!levels) return tl::unexpected<Error>(levels.error());
      take(before, *levels, session_->now() - begin);
      before = *levels;
      const auto waited = session_->wait([] { return false; }, session_->now() + kEvery);
      if (!waited && waited.error().code != Errc::interrupted) return tl::unexpected<Error>(waited.error());
    }
    return result(session_->now() - begin);
  }

 private:
  Result<std::uint32_t> read() {
    const auto answer = session_->upload(node_, kInputs);
    if (answer) return static_cast<std::uint32_t>(load_le(*answer));
    auto error = answer.error();
    if (error.code == Errc::sdo_abort)
      error.hint = "this drive does not show its inputs at 60FDh; a parameter of the family may";
    return fail(std::move(error));
  }

  void take(std::optional<std::uint32_t> before, std::uint32_t levels, Duration time) {
    seen_high_ |= levels;
    seen_low_ |= ~levels;
    for (unsigned bit = 0; bit < kBits; ++bit) {
      const bool level = (levels >> bit & 1U) != 0;
      if (before && (*before >> bit & 1U) == (levels >> bit & 1U)) continue;
      if (before) ++changes_[bit];
      if (before || is_expected(bit)) tell(bit, level, time);
    }
  }

  void tell(unsigned bit, bool level, Duration time) {
    Record record{
        {"time", seconds_of(time)}, {"node", node_}, {"input", id_of(bit)}, {"level", level ? 1 : 0}};
    context_->emit(record,
                   fmt::format("{:10.3f}  {} {}", seconds_of(time), name_of(*context_, bit), level ? 1 : 0));
    if (context_->keeps_samples) events_.emplace_back(std::move(record));
  }

  bool is_expected(unsigned bit) const {
    return std::find(expected_.begin(), expected_.end(), bit) != expected_.end();
  }
  bool seen_both_ways(unsigned bit) const { return (seen_high_ & seen_low_) >> bit & 1U; }
  bool is_complete() const {
    return !expected_.empty() &&
           std::all_of(expected_.begin(), expected_.end(), [&](unsigned b) { return seen_both_ways(b); });
  }

  Criterion judge(unsigned bit) const {
    const bool both = seen_both_ways(bit);
    const bool high = (seen_high_ >> bit & 1U) != 0;
    auto out = report::holds(
        id_of(bit), name_of(*context_, bit), both,
        both ? "0, 1" : say(*context_, high ? "only 1" : "only 0", high ? "只有 1" : "只有 0"), "0, 1");
    if (changes_[bit] > 0)
      out.note =
          say(*context_, fmt::format("changed {} time{}", changes_[bit], changes_[bit] == 1 ? "" : "s"),
              fmt::format("变化 {} 次", changes_[bit]));
    return out;
  }

  TestResult result(Duration time) {
    TestResult out;
    out.test = "io";
    out.node = node_;
    out.seconds = seconds_of(time);
    for (const auto bit : expected_) out.criteria.push_back(judge(bit));
    std::uint32_t changed = 0;
    for (unsigned bit = 0; bit < kBits; ++bit) {
      if (changes_[bit] == 0 || is_expected(bit)) continue;
      ++changed;
      out.criteria.push_back(judge(bit));
    }
    if (expected_.empty())
      out.criteria.push_back(report::at_least(
          "inputs_changed", say(*context_, "inputs that changed", "有变化的输入"), changed, 1));
    if (context_->keeps_samples) out.figures.push_back({"events", std::move(events_), Show::json});
    return out;
  }

  Context* context_;
  session::Session* session_;
  std::uint8_t node_;
  std::vector<unsigned> expected_;
  std::uint32_t seen_high_ = 0;
  std::uint32_t seen_low_ = 0;
  std::array<std::uint32_t, kBits> changes_{};
  report::List events_;
};

Result<Value> run(Context& context, const Arguments& arguments) {
  if (context.nodes.size() != 1) return fail(Errc::usage, "'test io' watches one drive", "name it: -n 1");
  auto expected = expected_inputs(arguments);
  if (!expected) return tl::unexpected<Error>(expected.error());
  const auto length = time_option(arguments, "--for", kLength);
  if (!length) return tl::unexpected<Error>(length.error());
  auto result = InputTest(context, context.nodes.front(), std::move(*expected)).run(*length);
  if (!result) return tl::unexpected<Error>(result.error());
  return verdicts(context, arguments, {std::move(*result)});
}

}  // namespace

extern const Command kTestIo;
const Command kTestIo{
    .path = "test io",
    .summary = "Watch the inputs of a drive while you actuate them, with a verdict",
    .details =
        "Reads 60FDh every 10 ms and tells each change. With --expect it passes, and ends, as soon as each "
        "input named there was seen at 0 and at 1; without, it watches until the time is over (or Ctrl-C) "
        "and passes "
        "when any input changed. 0 and 1 are the bits as the drive sends them: whether 1 means actuated "
        "depends on the family and on the wiring. Exit code 1 when it fails. Moves nothing.",
    .parameters = kParameters,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run,
};

}  // namespace servoctl::commands
