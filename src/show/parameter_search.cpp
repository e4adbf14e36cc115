#include "show/parameter_search.hpp"

#include <algorithm>
#include <string>

namespace servoctl::show {

std::optional<WordsIn> words_in(const TopicQuery& query, const od::Parameter& parameter) {
  // `Pn0202` is found by `0202` as well.
  const auto digits = std::find_if(parameter.id.begin(), parameter.id.end(), is_decimal_digit);
  const std::string number(digits, parameter.id.end());
  auto text = searchable({parameter.id, number, parameter.name, parameter.name_zh});
  if (query.mentions(text)) return WordsIn::name;
  for (const auto& label : parameter.labels) text += searchable({label.label, label.label_zh});
  if (query.mentions(text)) return WordsIn::labels;
  text += searchable({parameter.note, parameter.note_zh});
  return query.mentions(text) ? std::optional(WordsIn::note) : std::nullopt;
}

}  // namespace servoctl::show
