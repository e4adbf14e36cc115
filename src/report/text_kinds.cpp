#include "report/text_kinds.hpp"

#include <algorithm>
#include <cctype>

#include "report/text_parts.hpp"

namespace servoctl::report {
namespace {

bool has_joint(std::string_view text, Joint joint) { return parts_at(text, joint).parts.size() > 1; }

bool is_several(std::string_view text) {
  return has_joint(text, Joint::colons) || has_joint(text, Joint::clauses) ||
         has_joint(text, Joint::sentences);
}

/// Ends within brackets, or begins there.
bool is_cut(std::string_view text) {
  std::size_t open = 0;
  for (const char c : text) {
    if (c == ')' && open == 0) return true;
    if (c == '(') ++open;
    if (c == ')') --open;
  }
  return open > 0;
}

}  // namespace

bool has_letters(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; });
}

bool is_name(std::string_view text) {
  const bool quoted = text.size() > 2 && text.starts_with('`') && text.find('`', 1) == text.size() - 1;
  return !text.empty() && (quoted || text.find(' ') == std::string_view::npos);
}

bool is_place(std::string_view text) {
  for (const std::string_view lead : {"node ", "axis ", "bus "})
    if (text.starts_with(lead)) text.remove_prefix(lead.size());
  if (const auto object = text.find(", object "); object != std::string_view::npos)
    text = text.substr(0, object);
  return !text.empty() && text.find(' ') == std::string_view::npos;
}

bool is_plural(std::string_view ending) {
  constexpr std::string_view kEndings[] = {"s", "es", "is", " was", "s were"};
  return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings);
}

bool takes_too_much(const Phrase& phrase, std::size_t place, std::string_view value) {
  const bool kept = phrase.places()[place].quoted;
  if (!kept && is_cut(value)) return true;
  if (place == 0 && phrase.pieces().front().empty()) return is_several(value);
  const bool last = place + 1 == phrase.places().size() && !has_letters(phrase.pieces().back());
  if (last) return has_joint(value, Joint::clauses) || has_joint(value, Joint::brackets);
  return !kept && is_several(value);
}

}  // namespace servoctl::report
