#include "trial/io_trial.hpp"

#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "drive/standard_objects.hpp"
#include "session/stretch.hpp"
#include "trial/figures.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {
namespace {

using report::Criterion;
using report::Record;
using report::TestResult;

constexpr unsigned kBits = 32;
constexpr Duration kEvery = std::chrono::milliseconds(10);

/// What the bits of 60FDh are called: three by their function (CiA 402-2), which families put elsewhere, the
/// others by their number.
class InputNames {
 public:
  explicit InputNames(const show::Desk& desk) : desk_(&desk) {
    if (desk.profile != nullptr) rules_ = desk.profile->rules.motion;
  }
  /// Whether the switch of this input is actuated.
  bool is_actuated(std::uint32_t levels, unsigned bit) const { return rules_.is_actuated(levels, bit); }

  std::string id(unsigned bit) const {
    const auto function = function_of(bit);
    return function ? std::string(kIds[*function]) : formatted("bit{}", bit);
  }
  std::string name(unsigned bit) const {
    const auto function = function_of(bit);
    // In English as they are typed.
    if (!desk_->speaks_chinese()) return id(bit);
    return say(*desk_, function ? std::string(kNames[*function]) : formatted("bit {}", bit));
  }
  Result<unsigned> parse(std::string_view word) const {
    std::vector<std::string> words;
    for (unsigned bit = 0; bit < kBits; ++bit) {
      if (equals_nocase(word, id(bit)) || equals_nocase(word, formatted("bit{}", bit))) return bit;
      words.push_back(id(bit));
    }
    auto hint = did_you_mean(word, words);
    if (hint.empty()) hint = "use negative-limit, positive-limit, home, or bit0 to bit31 of 60FDh";
    return fail(Errc::usage, message("'{}' is not an input", as_it_is(word)), std::move(hint));
  }

 private:
  static constexpr std::array<std::string_view, 3> kIds{"negative-limit", "positive-limit", "home"};
  static constexpr std::array<std::string_view, 3> kNames{"negative limit", "positive limit", "home switch"};

  std::optional<std::size_t> function_of(unsigned bit) const {
    for (std::size_t i = 0; i < std::min(rules_.inputs.size(), kIds.size()); ++i)
      if (rules_.inputs[i] == bit) return i;
    return std::nullopt;
  }

  const show::Desk* desk_;
  drive::MotionRules rules_;
};

/// Watches the inputs of one drive while somebody actuates them.
class InputWatch {
 public:
  InputWatch(show::Desk& desk, std::uint8_t node, std::vector<unsigned> expected)
      : desk_(&desk), session_(desk.session), node_(node), names_(desk), expected_(std::move(expected)) {}

  Result<TestResult> run(Duration length) {
    const auto begin = session_->now();
    const auto end = begin + length;
    const session::Stretch stretch(*session_, end, session::Stretch::End::at_latest);
    std::optional<std::uint32_t> before;
    while (session_->now() < end && !is_complete()) {
      const auto levels = read();
      if (!levels && levels.error().code == Errc::interrupted) break;
      if (!levels) return fail(levels.error());
      take(before, *levels, session_->now() - begin);
      before = *levels;
      const auto waited = session_->wait([] { return false; }, session_->now() + kEvery);
      if (!waited && waited.error().code != Errc::interrupted) return fail(waited.error());
    }
    return result(session_->now() - begin);
  }

 private:
  Result<std::uint32_t> read() {
    const auto answer = session_->upload(node_, objects::kDigitalInputs);
    if (answer) return static_cast<std::uint32_t>(load_le(*answer));
    auto error = answer.error();
    if (error.code == Errc::sdo_abort)
      error.hint = "this drive does not show its inputs in 60FDh; a parameter of the family may";
    return fail(std::move(error));
  }

  void take(std::optional<std::uint32_t> before, std::uint32_t levels, Duration time) {
    seen_high_ |= levels;
    seen_low_ |= ~levels;
    for (unsigned bit = 0; bit < kBits; ++bit) {
      if (before && (*before >> bit & 1U) == (levels >> bit & 1U)) continue;
      if (before) ++changes_[bit];
      if (before || is_expected(bit)) tell(bit, levels, time);
    }
  }

  void tell(unsigned bit, std::uint32_t levels, Duration time) {
    const int level = (levels >> bit & 1U) != 0 ? 1 : 0;
    const bool on = names_.is_actuated(levels, bit);
    Record record{{"time", seconds_of(time)},
                  {"node", node_},
                  {"input", names_.id(bit)},
                  {"level", level},
                  {"actuated", on}};
    const auto text = say(*desk_, on ? "actuated" : "not actuated");
    desk_->emit(record, formatted("{:10.3f}  {} {} ({})", seconds_of(time), names_.name(bit), level, text));
    if (desk_->keeps_samples) events_.emplace_back(std::move(record));
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
    auto out = report::holds(names_.id(bit), names_.name(bit), both,
                             both ? "0, 1" : say(*desk_, high ? "only 1" : "only 0"), "0, 1");
    if (changes_[bit] > 0)
      out.note = say(*desk_, changes_[bit] == 1 ? std::string("changed once")
                                                : formatted("changed {} times", changes_[bit]));
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
      out.criteria.push_back(
          report::at_least("inputs_changed", say(*desk_, "inputs that changed"), changed, 1));
    out.figures.push_back(
        events_figure(desk_->keeps_samples ? report::Value(std::move(events_)) : report::Value()));
    return out;
  }

  show::Desk* desk_;
  session::Session* session_;
  std::uint8_t node_;
  InputNames names_;
  std::vector<unsigned> expected_;
  std::uint32_t seen_high_ = 0;
  std::uint32_t seen_low_ = 0;
  std::array<std::uint32_t, kBits> changes_{};
  report::List events_;
};

}  // namespace

Result<std::vector<unsigned>> parse_inputs(const show::Desk& desk, std::string_view text) {
  const InputNames names(desk);
  std::vector<unsigned> out;
  for (const auto word : split(text, ',')) {
    const auto bit = names.parse(trim(word));
    if (!bit) return fail(bit.error());
    if (std::find(out.begin(), out.end(), *bit) == out.end()) out.push_back(*bit);
  }
  return out;
}

Result<TestResult> test_inputs(show::Desk& desk, std::uint8_t node, const InputTrial& test) {
  return InputWatch(desk, node, test.expected).run(test.length);
}

}  // namespace servoctl::trial
