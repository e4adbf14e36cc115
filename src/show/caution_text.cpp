#include "show/caution_text.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "base/text.hpp"
#include "report/catalogue.hpp"

namespace servoctl::show {
namespace {

constexpr std::string_view kBothLimits = "both limit switches";
constexpr std::string_view kOther = "{} other than {}";
constexpr std::string_view kNoneIs = "None of {}, {} is {}";
constexpr std::string_view kFactory = " (factory value)";
constexpr std::string_view kMasked =
    "{}{}: the drive ignores {}. No motion stops there, and servoctl refuses homing methods that need an ignored switch.";
constexpr std::string_view kBlocked = "{}{}: this is not possible: {}.";
constexpr std::string_view kNoMethod = "{}{}: these homing methods (6098h) are not possible: {}.";
constexpr std::string_view kEnding = "To end this, set {}.";
constexpr std::string_view kEndingByRestart = "To end this, set {} and restart the drive.";
constexpr std::string_view kSlower = "Above {}, --limit is needed.";
constexpr std::string_view kWeaker = "Above {}, --max-torque is needed.";

/// Sentences of one caution in one language.
class CautionWords {
 public:
  CautionWords(const drive::Profile& profile, const drive::Caution& caution, bool chinese)
      : profile_(&profile), caution_(&caution), chinese_(chinese) {}

  std::string text() {
    if (!caution_->masks.empty()) add(kMasked, condition(), factory(), switches());
    if (!caution_->blocks.empty()) add(kBlocked, condition(), factory(), uses());
    if (!caution_->methods.empty())
      add(kNoMethod, condition(), factory(), fmt::to_string(fmt::join(caution_->methods, ", ")));
    add_text(chinese_ && !caution_->text_zh.empty() ? caution_->text_zh : caution_->text);
    if (!caution_->speed.empty()) add(kSlower, caution_->speed);
    if (!caution_->torque.empty()) add(kWeaker, caution_->torque);
    const auto ending = ending_setting(*caution_);
    if (caution_->is_rule() && !ending.empty())
      add(needs_restart(*profile_, *caution_) ? kEndingByRestart : kEnding, ending);
    return std::move(out_);
  }

 private:
  std::string say(std::string_view english) const {
    return std::string(chinese_ ? report::chinese_word(english) : english);
  }

  template <class... Parts>
  void add(std::string_view pattern, const Parts&... parts) {
    add_text(formatted(fmt::runtime(say(pattern)), parts...));
  }

  void add_text(std::string_view sentence) {
    if (!sentence.empty()) append(out_, sentence, chinese_ ? "" : " ");
  }

  std::string condition() const {
    if (caution_->not_value && !caution_->others.empty())
      return formatted(fmt::runtime(say(kNoneIs)), caution_->name, fmt::join(caution_->others, ", "),
                       *caution_->not_value);
    if (caution_->value) return formatted("{} = {}", caution_->name, *caution_->value);
    if (caution_->not_value)
      return formatted(fmt::runtime(say(kOther)), caution_->name, *caution_->not_value);
    return profile_->family;
  }

  std::string factory() const {
    const auto* parameter = profile_->parameter(caution_->name);
    if (!caution_->others.empty() || parameter == nullptr || !parameter->default_value ||
        !caution_->is_conditional())
      return {};
    return caution_->holds(od::to_double(*parameter->default_value)) ? say(kFactory) : std::string();
  }

  std::string switches() const {
    std::string out;
    const bool both = caution_->masks_input(drive::Input::negative_limit) &&
                      caution_->masks_input(drive::Input::positive_limit);
    if (both) out = say(kBothLimits);
    for (const auto input : caution_->masks)
      if (!both || input == drive::Input::home) append(out, say(name(input)));
    return out;
  }

  std::string uses() const {
    constexpr std::array<std::string_view, 5> kUseNames{"enable", "jog", "move", "home", "torque"};
    std::string out;
    for (const auto use : caution_->blocks)
      append(out, std::string(kUseNames[static_cast<std::size_t>(use)]), ", ");
    return out;
  }

  const drive::Profile* profile_;
  const drive::Caution* caution_;
  bool chinese_;
  std::string out_;
};

}  // namespace

std::string_view name(drive::Input input) {
  constexpr std::array<std::string_view, 3> kInputNames{"the negative limit switch",
                                                        "the positive limit switch", "the home switch"};
  return kInputNames[static_cast<std::size_t>(input)];
}

std::string ending_setting(const drive::Caution& caution) {
  return caution.set ? formatted("{} = {}", caution.name, *caution.set) : std::string();
}

bool needs_restart(const drive::Profile& profile, const drive::Caution& caution) {
  const auto* parameter = profile.parameter(caution.name);
  return parameter != nullptr && parameter->effect == od::Effect::restart;
}

std::string caution_text(const drive::Profile& profile, const drive::Caution& caution, bool chinese) {
  return CautionWords(profile, caution, chinese).text();
}

}  // namespace servoctl::show
