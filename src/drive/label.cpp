// The words that stand for values.
#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/quantity.hpp"

namespace servoctl::drive {
namespace {

/// Whether the text is one of the words that stand for the label, other than the whole of it.
bool is_short_form(std::string_view label, std::string_view text) {
  const auto words = label_words(label);
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return word != label && equals_nocase(word, text); });
}

}  // namespace

std::vector<std::string_view> label_words(std::string_view label) {
  std::vector<std::string_view> out{label};
  const auto open = label.find(" (");
  if (open == std::string_view::npos) return out;
  out.push_back(label.substr(0, open));
  const auto last = label.rfind('(');
  const auto close = label.find(')', last);
  if (close == std::string_view::npos) return out;
  const auto inside = label.substr(last + 1, close - last - 1);
  if (!parse_integer(inside) && !parse_real(inside)) out.push_back(inside);
  return out;
}

const od::EnumLabel* find_label(const Meaning& meaning, std::string_view text) {
  if (meaning.labels == nullptr) return nullptr;
  const od::EnumLabel* brief = nullptr;
  std::size_t briefs = 0;
  for (const auto& label : *meaning.labels) {
    if (equals_nocase(label.label, text) || (!label.label_zh.empty() && label.label_zh == text))
      return &label;
    if (!is_short_form(label.label, text) && !is_short_form(label.label_zh, text)) continue;
    brief = &label;
    ++briefs;
  }
  return briefs == 1 ? brief : nullptr;
}

const od::EnumLabel* label_of(const Meaning& meaning, const od::Value& value) {
  if (meaning.labels == nullptr) return nullptr;
  for (const auto& label : *meaning.labels)
    if (od::compare_numbers(value, od::Value(label.value)) == 0 &&
        !std::holds_alternative<std::string>(value) && !std::holds_alternative<Bytes>(value))
      return &label;
  return nullptr;
}

std::string labels_text(const std::vector<od::EnumLabel>& labels) {
  std::string out;
  for (const auto& label : labels) append(out, formatted("{} {}", label.value, label.label));
  return out;
}

}  // namespace servoctl::drive
