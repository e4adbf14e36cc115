#include "report/text_parts.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace servoctl::report {
namespace {

constexpr std::string_view kBefore = " \t\n,;:";
constexpr std::string_view kBehind = " \t\n,;:.";

bool is_small(char c) { return c >= 'a' && c <= 'z'; }
bool is_alphanumeric(char c) {
  return is_small(c) || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         static_cast<unsigned char>(c) >= 0x80;
}

/// Follows a text through its quotes and brackets. The apostrophe of `drive's` is no quote.
class Walk {
 public:
  explicit Walk(std::string_view text) : text_(text) {}

  /// Takes the character at `at`; whether it, or what is behind it, stands in a quote.
  bool quoted(std::size_t at) {
    const char c = text_[at];
    if (quote_ != 0) {
      const bool ends =
          c == quote_ && (c == '`' || at + 1 == text_.size() || !is_alphanumeric(text_[at + 1]));
      if (ends) quote_ = 0;
      return true;
    }
    const bool opens = c == '`' || (c == '\'' && (at == 0 || !is_alphanumeric(text_[at - 1])));
    if (opens && text_.find(c, at + 1) != std::string_view::npos) {
      quote_ = c;
      return true;
    }
    if (c == '(') ++depth_;
    if (c == ')' && depth_ > 0) --depth_;
    return false;
  }
  bool bracketed() const { return depth_ > 0; }

 private:
  std::string_view text_;
  char quote_ = 0;
  std::size_t depth_ = 0;
};

std::size_t blanks_at(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && text[end] == ' ') ++end;
  return end - at;
}

/// Bytes of the joint that begins here; 0 where none does.
std::size_t joint_size(std::string_view text, std::size_t at, Joint joint) {
  const auto rest = text.substr(at);
  switch (joint) {
    case Joint::lines: return rest.starts_with('\n') ? 1 : 0;
    case Joint::columns: return blanks_at(text, at) >= 2 ? blanks_at(text, at) : 0;
    case Joint::sentences: return rest.starts_with(". ") || rest.starts_with("? ") ? 2 : 0;
    case Joint::clauses: return rest.starts_with("; ") ? 2 : 0;
    case Joint::colons: return rest.starts_with(": ") ? 2 : 0;
    case Joint::dashes: return rest.starts_with(" - ") ? 3 : rest.starts_with(" — ") ? 5 : 0;
    case Joint::commas: return rest.starts_with(", ") ? 2 : 0;
    case Joint::brackets: return 0;
  }
  return 0;
}

/// `what (more)`: two parts, and brackets around the second.
TextParts bracket_parts(std::string_view text) {
  if (!text.ends_with(')')) return {{text}, {{}}};
  Walk walk(text);
  std::size_t opened = std::string_view::npos;
  bool inside = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (walk.quoted(at)) continue;
    if (!inside && walk.bracketed()) opened = at;
    inside = walk.bracketed();
  }
  if (opened == std::string_view::npos || inside || opened + 2 >= text.size()) return {{text}, {{}}};
  const bool blank = opened > 0 && text[opened - 1] == ' ';
  const auto first = text.substr(0, opened - (blank ? 1 : 0));
  return {{first, text.substr(opened + 1, text.size() - opened - 2)},
          {text.substr(first.size(), opened + 1 - first.size()), text.substr(text.size() - 1)}};
}

}  // namespace

BareText bare(std::string_view text) {
  auto begin = text.find_first_not_of(kBefore);
  if (begin == std::string_view::npos) return {text, {}, {}};
  auto end = text.find_last_not_of(kBehind) + 1;
  if (end <= begin) return {text, {}, {}};
  // `...` is no full stop.
  if (text.substr(end).starts_with("..")) end = text.find_last_not_of(" \t\n") + 1;
  return {text.substr(0, begin), text.substr(begin, end - begin), text.substr(end)};
}

std::string punctuation_zh(std::string_view marks) {
  std::string out;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    std::string_view mark;
    switch (marks[i]) {
      case ',': mark = "，"; break;
      case ';': mark = "；"; break;
      case ':': mark = "："; break;
      case '.': mark = "。"; break;
      case '?': mark = "？"; break;
      case '(': mark = "（"; break;
      case ')': mark = "）"; break;
      default: break;
    }
    if (mark.empty()) {
      out += marks[i];
      continue;
    }
    // A wide mark has its blank within it.
    if (marks[i] == '(' && out.ends_with(' ')) out.pop_back();
    out += mark;
    if (i + 1 < marks.size() && marks[i + 1] == ' ') ++i;
  }
  return out;
}

TextParts parts_at(std::string_view text, Joint joint) {
  if (joint == Joint::brackets) return bracket_parts(text);
  const bool into_brackets = joint == Joint::lines || joint == Joint::columns;
  TextParts out;
  Walk walk(text);
  std::size_t begin = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (joint != Joint::lines && walk.quoted(at)) continue;
    if (!into_brackets && walk.bracketed()) continue;
    const auto size = joint_size(text, at, joint);
    if (size == 0) continue;
    // A question keeps its mark: the sentence of the catalogue has it.
    const std::size_t own = text[at] == '?' ? 1 : 0;
    out.parts.push_back(text.substr(begin, at + own - begin));
    out.joints.push_back(text.substr(at + own, size - own));
    begin = at + size;
    at = begin - 1;
  }
  out.parts.push_back(text.substr(begin));
  out.joints.emplace_back();
  return out;
}

namespace {

/// They are the same in every language.
bool is_unit(std::string_view word) {
  static constexpr std::string_view kUnits[] = {"rpm", "ms", "us",    "ns",  "deg", "rad",
                                                "inc", "mm", "pulse", "rev", "ohm", "pps"};
  return std::find(std::begin(kUnits), std::end(kUnits), word) != std::end(kUnits);
}

bool is_in_capitals(std::string_view word) {
  return word.size() >= 2 &&
         std::all_of(word.begin(), word.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

}  // namespace

bool begins_in_capitals(std::string_view text) {
  const auto first = text.find(' ');
  if (first == std::string_view::npos) return false;
  const auto rest = text.substr(first + 1);
  return is_in_capitals(text.substr(0, first)) && is_in_capitals(rest.substr(0, rest.find(' ')));
}

std::size_t small_words(std::string_view text) {
  // Of a sentence in capitals; one or two are abbreviations.
  constexpr std::size_t kSentence = 3;
  std::size_t capitals = 0;
  constexpr std::string_view kEnds = " ,;:.?!()\n";
  const auto ends = [&](std::size_t at) {
    if (at >= text.size()) return true;
    // `a.csv`, `coe:sim`, `1,3`.
    const bool joins = std::string_view(".,:?").find(text[at]) != std::string_view::npos;
    const bool in_name = joins && at + 1 < text.size() && text[at + 1] != ' ' && text[at + 1] != '\n';
    return !in_name && kEnds.find(text[at]) != std::string_view::npos;
  };
  Walk walk(text);
  std::size_t out = 0;
  std::size_t letters = 0;
  bool plain = true;  // Since the word began.
  for (std::size_t at = 0; at <= text.size(); ++at) {
    const bool quoted = at < text.size() && walk.quoted(at);
    if (!quoted && ends(at)) {
      const auto word = text.substr(at - letters, letters);
      if (plain && letters >= 2 && !is_unit(word)) ++out;
      if (letters > 0) capitals = is_in_capitals(word) ? capitals + 1 : 0;
      if (capitals >= kSentence) out += capitals == kSentence ? kSentence : 1;
      letters = 0;
      plain = true;
    } else {
      plain = plain && !quoted && is_small(text[at]);
      ++letters;
    }
  }
  return out;
}

}  // namespace servoctl::report
