#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include "base/utf8.hpp"
#include "report/catalogue.hpp"
#include "report/chinese_marks.hpp"
#include "report/text_kinds.hpp"
#include "report/text_parts.hpp"

namespace servoctl::report {
namespace {

/// A longer text is taken apart before it is held against patterns.
constexpr std::size_t kLongestPattern = 4000;
/// So many patterns that fit are tried for one that leaves no English.
constexpr std::size_t kMostTried = 6;
/// Parts next to each other that may be one text of the catalogue.
constexpr std::size_t kLongestRun = 4;
/// How deep texts within texts are followed.
constexpr std::size_t kDeepest = 10;
/// Patterns that are tried for one text, and for each of its bytes: what is made to take time is left alone.
constexpr std::size_t kLeastEffort = 20'000;
constexpr std::size_t kEffortPerByte = 200;
/// With fewer letters a pattern fits too much: it is taken where nothing around it stays English.
constexpr std::size_t kFewLetters = 10;

struct Translated {
  std::string text;
  std::size_t left = 0;  ///< Words in it that are still English, as far as one can tell.
  bool changed = false;
};

/// The work on one text.
class Translation {
 public:
  Translation(const Catalogue& catalogue, const Names* names, std::size_t size)
      : catalogue_(&catalogue), names_(names), effort_(kLeastEffort + size * kEffortPerByte) {}

  Translated of(std::string_view text) {
    if (depth_ > kDeepest || effort_ == 0 || !has_letters(text)) return as_it_is(text);
    --effort_;
    const auto known = known_.find(std::string(text));
    if (known != known_.end()) return known->second;
    ++depth_;
    const auto inner = bare(text);
    auto out = of_bare(inner.text);
    --depth_;
    if (out.changed)
      out.text = punctuation_zh(inner.before) + out.text + punctuation_zh(inner.behind);
    else
      out.text = text;
    known_.emplace(text, out);
    return out;
  }

 private:
  std::optional<std::string> all_of(std::string_view text) const {
    const auto found = catalogue_->whole(text);
    if (!found.empty()) return std::string(found);
    if (names_ == nullptr) return std::nullopt;
    const auto name = names_->find(std::string(text));
    return name == names_->end() ? std::nullopt : std::optional(name->second);
  }

  Translated of_bare(std::string_view text) {
    if (auto found = all_of(text)) return {std::move(*found), 0, true};
    if (auto found = behind_place(text)) return std::move(*found);
    if (auto found = behind_name(text)) return std::move(*found);
    if (auto found = before_round(text)) return std::move(*found);
    auto best = around(text);
    const auto take = [&](Translated&& other) {
      if (other.changed && (!best || other.left < best->left)) best = std::move(other);
      return best && best->left == 0;
    };
    if (best && best->left == 0) return std::move(*best);
    if (take(behind_sign(text)) || take(behind_colon(text))) return std::move(*best);
    if (take(names_in_words(text))) return std::move(*best);
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      const auto parts = parts_at(text, static_cast<Joint>(joint));
      if (parts.parts.size() < 2) continue;
      if (take(in_parts(parts, static_cast<Joint>(joint)))) break;
    }
    if (!best || best->left > 0) take(of_axis(text));
    return best ? std::move(*best) : as_it_is(text);
  }

  /// A sentence that is known as a whole, behind a place; nothing for others.
  std::optional<Translated> behind_place(std::string_view text) {
    constexpr std::size_t kWords = 3;
    const auto parts = parts_at(text, Joint::colons);
    if (parts.parts.size() < 2 || !is_place(parts.parts.front())) return std::nullopt;
    const auto& place = parts.parts.front();
    const auto rest = text.substr(place.size() + parts.joints.front().size());
    if (auto inner = behind_place(rest)) return Translated{of(place).text + "：" + inner->text, 0, true};
    auto found = rest.find('\n') == std::string_view::npos ? all_of(bare(rest).text) : std::nullopt;
    if (!found || std::count(rest.begin(), rest.end(), ' ') < static_cast<std::ptrdiff_t>(kWords))
      return std::nullopt;
    return Translated{of(place).text + "：" + *found, 0, true};
  }

  /// `Pn0214 Speed loop gain 1: …`, whatever words the name has; nothing for others.
  std::optional<Translated> behind_name(std::string_view text) {
    const auto colon = text.find(": ");
    if (names_ == nullptr || colon == std::string_view::npos) return std::nullopt;
    const auto name = names_->find(std::string(text.substr(0, colon)));
    if (name == names_->end()) return std::nullopt;
    auto rest = of(text.substr(colon + 2));
    return Translated{name->second + "：" + rest.text, rest.left, true};
  }

  /// `feeder: …` and `feeder, object 0x6041:0`, of an axis by its name, are told as `node 1: …` is.
  Translated of_axis(std::string_view text) {
    const auto name = text.substr(0, std::min(text.find(": "), text.find(", object ")));
    const bool lower = std::any_of(name.begin(), name.end(), [](char c) { return c >= 'a' && c <= 'z'; });
    // Neither `LSS slave: …` nor `INTERFACE: …` tells of an axis.
    if (signs_ > 0 || !lower || name == text || name.find_first_of(" :,`'\"\n") != std::string_view::npos)
      return as_it_is(text);
    auto out = of(std::string("node ").append(text));
    const std::string before = "节点 ";
    if (out.left > small_words(name) || !out.text.starts_with(before + std::string(name)))
      return as_it_is(text);
    out.text.erase(0, before.size());
    return has_chinese(out.text) ? Translated{std::move(out.text), 0, true} : as_it_is(text);
  }

  /// `… [NODE=1]`: a batch file and its round; nothing for others.
  std::optional<Translated> before_round(std::string_view text) {
    const auto at = text.rfind(" [");
    if (at == std::string_view::npos || at == 0 || !text.ends_with(']') ||
        text.find('=', at) == std::string_view::npos)
      return std::nullopt;
    auto out = of(text.substr(0, at));
    out.text += text.substr(at);
    return out;
  }

  /// `json, csv or batch`: names without blanks.
  Translated names_in_words(std::string_view text) const {
    for (const auto& [word, chinese] : {std::pair<std::string_view, std::string_view>{" or ", " 或 "},
                                        std::pair<std::string_view, std::string_view>{" and ", " 和 "}}) {
      const auto at = text.rfind(word);
      if (at == std::string_view::npos || at == 0) continue;
      std::string out;
      bool all = true;
      for (const auto name : parts_at(text.substr(0, at), Joint::commas).parts) {
        all = all && is_name(name);
        (out += out.empty() ? "" : "、") += name;
      }
      const auto last = text.substr(at + word.size());
      if (!all || !is_name(last)) continue;
      return {out + std::string(chinese) + std::string(last), 0, true};
    }
    return as_it_is(text);
  }

  /// `watchdog: …`, where what follows is one text although it has clauses of its own.
  Translated behind_colon(std::string_view text) {
    const auto parts = parts_at(text, Joint::colons);
    if (parts.parts.size() < 2 || text.find('\n') != std::string_view::npos) return as_it_is(text);
    const auto& first = parts.parts.front();
    const auto lead = of(first);
    auto out = of(text.substr(first.size() + parts.joints.front().size()));
    // One word at the beginning that is not known is the name of an axis, a bus or a file.
    if (depth_ > 1 || lead.changed || first.find(' ') != std::string_view::npos) out.left += lead.left;
    out.changed = out.changed || lead.changed;
    out.text = lead.text + joint_zh(parts.joints.front(), out) + out.text;
    return out;
  }

  /// `0x11 generic`, `4 segment …`, `LSS …`: a number or a sign, and a text behind it.
  Translated behind_sign(std::string_view text) {
    const auto blank = text.find(' ');
    const auto sign = text.substr(0, blank);
    const bool is_sign =
        blank != std::string_view::npos && !sign.ends_with(':') &&
        (sign.starts_with("0x") || sign == "×" || std::none_of(sign.begin(), sign.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || static_cast<unsigned char>(c) >= 0x80;
         }));
    // The words of a sentence in capitals are no signs.
    if (!is_sign || begins_in_capitals(text)) return as_it_is(text);
    ++signs_;
    auto out = of(text.substr(blank + 1));
    --signs_;
    return {std::string(text.substr(0, blank + 1)) + out.text, out.left, out.changed};
  }

  static Translated as_it_is(std::string_view text) { return {std::string(text), small_words(text)}; }

  /// Of the patterns that fit the one that leaves the least English; of two the one with more letters.
  std::optional<Translated> around(std::string_view text) {
    if (text.size() > kLongestPattern) return std::nullopt;
    std::optional<Translated> best;
    std::size_t tried = 0;
    for (const auto* pattern : catalogue_->candidates(text)) {
      if (effort_ == 0 || tried == kMostTried) break;
      --effort_;
      const auto values = pattern->id.match(text);
      if (!values) continue;
      ++tried;
      auto out = with_values(*pattern, *values);
      if (!out) continue;
      if (!best || out->left < best->left) best = std::move(out);
      if (best->left == 0) break;
    }
    return best;
  }

  /// Nothing where the pattern is too small for what stands around it.
  std::optional<Translated> with_values(const Catalogue::Pattern& pattern,
                                        const std::vector<std::string_view>& values) {
    const bool small = pattern.id.letters() < kFewLetters;
    const bool led = !pattern.id.pieces().front().empty();
    Translated out{{}, 0, true};
    std::vector<std::string> arguments;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& place = pattern.id.places()[i];
      auto value = place.quoted ? Translated{std::string(values[i])} : of(values[i]);
      // In Chinese there is no plural.
      if (place.suffix && is_plural(value.text)) value = {};
      const bool is_name = led && values[i].find(' ') == std::string_view::npos;
      if (small && value.left > 0 && !value.changed && !is_name) return std::nullopt;
      if (takes_too_much(pattern.id, i, values[i])) ++out.left;
      out.left += value.left;
      arguments.resize(std::max(arguments.size(), place.argument + 1));
      arguments[place.argument] = std::move(value.text);
    }
    out.text = Phrase(pattern.text).with(arguments);
    return out;
  }

  /// Neighbours that are one text of the catalogue are put into Chinese as one.
  Translated in_parts(const TextParts& parts, Joint joint) {
    Translated out;
    for (std::size_t i = 0; i < parts.parts.size();) {
      auto [part, count] = run_at(parts, i, joint);
      out.left += part.left;
      out.changed = out.changed || part.changed;
      out.text += part.text;
      i += count;
      auto both = part;
      // Brackets open and close in one way.
      const auto other = joint == Joint::brackets ? 1 - (i - 1) : i;
      both.changed = both.changed || (other < parts.parts.size() &&
                                      (of(parts.parts[other]).changed || has_chinese(parts.parts[other])));
      out.text +=
          joint <= Joint::columns ? std::string(parts.joints[i - 1]) : joint_zh(parts.joints[i - 1], both);
    }
    return out;
  }

  /// The mark stays as it was between what stays as it was. Behind a wide one is no blank.
  static std::string joint_zh(std::string_view joint, const Translated& beside) {
    if (!beside.changed && !has_chinese(beside.text)) return std::string(joint);
    return joint == " " && beside.text.ends_with("？") ? std::string() : punctuation_zh(joint);
  }

  std::pair<Translated, std::size_t> run_at(const TextParts& parts, std::size_t at, Joint joint) {
    const auto most = joint == Joint::columns || joint == Joint::brackets
                          ? 1
                          : std::min(kLongestRun, parts.parts.size() - at);
    for (auto count = most; count > 1; --count) {
      const auto* begin = parts.parts[at].data();
      const auto& last = parts.parts[at + count - 1];
      const std::string_view run(begin, static_cast<std::size_t>(last.data() + last.size() - begin));
      if (count == parts.parts.size()) continue;  // That was tried.
      const auto inner = bare(run);
      if (auto found = all_of(inner.text))
        return {{punctuation_zh(inner.before) + *found + punctuation_zh(inner.behind), 0, true}, count};
      if (auto found = around(inner.text); found && found->left == 0) {
        found->text = punctuation_zh(inner.before) + found->text + punctuation_zh(inner.behind);
        return {std::move(*found), count};
      }
    }
    return {of(parts.parts[at]), 1};
  }

  const Catalogue* catalogue_;
  const Names* names_;
  std::size_t effort_;
  std::size_t depth_ = 0;
  std::size_t signs_ = 0;  ///< Before what is looked at.
  std::unordered_map<std::string, Translated> known_;
};

}  // namespace

std::string Catalogue::translated(std::string_view text, const Names* names) const {
  return chinese_marks(Translation(*this, names, text.size()).of(text).text);
}

}  // namespace servoctl::report
