#include "show/topic_query.hpp"

#include <algorithm>
#include <array>

#include "base/folded.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "show/printed_number.hpp"

namespace servoctl::show {
namespace {

/// What names are compared by.
std::string key_of(std::string_view text) {
  auto out = folded(text);
  std::erase_if(out, [](char c) { return c == ' ' || c == '_'; });
  return out;
}

/// What displays are compared by: without marks between letters and digits, and zeros before a number.
std::string display_key(std::string_view text) {
  std::string out;
  const auto key = key_of(text);
  for (std::size_t i = 0; i < key.size(); ++i) {
    const bool behind_digit = !out.empty() && is_decimal_digit(out.back());
    const bool mark = key[i] == '.' || key[i] == '-';
    const bool zero = key[i] == '0' && i + 1 < key.size() && is_decimal_digit(key[i + 1]);
    if ((mark || zero) && !behind_digit) continue;
    out += key[i];
  }
  return out;
}

/// Whether the cell is this number with a unit: `500 kbit/s` is `500` and `500k`.
bool is_quantity(std::string_view cell, std::string_view word) {
  if (word.empty() || word.front() < '0' || word.front() > '9') return false;
  const auto key = key_of(cell);
  if (!key.starts_with(word) || key.find_first_of("0123456789", word.size()) != std::string::npos)
    return false;
  const bool all_digits = word.find_first_not_of("0123456789") == std::string_view::npos;
  return !all_digits || cell.substr(word.size()).starts_with(" ");
}

/// Whether the cells of the column may be numbers of rows: not steps, nor what a bit or an input that heads
/// the column (`bit 7`, `12`, `SP1`) is in each row.
bool is_countable(std::string_view heading) {
  return heading != "step" && (heading.empty() || !is_decimal_digit(heading.back()));
}

bool has_steps(const drive::Topic& topic) {
  return std::find(topic.columns.begin(), topic.columns.end(), "step") != topic.columns.end();
}

/// The column that numbers the rows: the first, or behind names one that is called so.
std::size_t number_column(const drive::Topic& topic) {
  constexpr std::array<std::string_view, 4> kCalled{"value", "no.", "number", "code"};
  const auto& columns = topic.columns;
  const auto first =
      static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), is_countable) - columns.begin());
  const bool numbers =
      first < columns.size() &&
      std::any_of(topic.rows.begin(), topic.rows.end(), [&](const drive::TopicRow& row) {
        return std::any_of(row.cells[first].begin(), row.cells[first].end(), is_decimal_digit);
      });
  const auto called = std::find_first_of(columns.begin(), columns.end(), kCalled.begin(), kCalled.end());
  return numbers || called == columns.end() ? first : static_cast<std::size_t>(called - columns.begin());
}

/// Words that tell by themselves: no number, one that says that it is hexadecimal, one of three digits.
bool is_telling(std::string_view word) {
  constexpr std::size_t kTellingDigits = 3;
  return !parse_signed(word) || is_marked_hex(word) || word.size() >= kTellingDigits;
}

/// What people call the kinds of topics that are counted.
struct KindWords {
  std::string_view kind;
  std::array<std::string_view, 6> words;
};
constexpr std::array kKindWords{
    KindWords{"homing", {"homing", "homing method", "home", "回零", "回零方式", "回原点方式"}},
    KindWords{"mode", {"mode", "mode of operation", "操作模式", "模式", "运行模式", "控制模式"}},
    KindWords{"state", {"state", "状态", {}, {}, {}, {}}},
};

bool is_called(std::string_view kind, std::string_view words) {
  if (words == kind) return true;
  return std::any_of(kKindWords.begin(), kKindWords.end(), [&](const KindWords& row) {
    return row.kind == kind && std::find(row.words.begin(), row.words.end(), words) != row.words.end();
  });
}

/// Whether the words name the object, by its address or by its name in the dictionary.
bool is_object(std::string_view words, ObjectAddress object, const od::Dictionary* dictionary) {
  if (const auto address = parse_object_address(words)) return *address == object;
  const auto* known = dictionary == nullptr ? nullptr : dictionary->object(object.index);
  return known != nullptr && !words.empty() && od::identifier(known->name) == od::identifier(words);
}

std::string haystack(const drive::Topic& topic) {
  auto out = searchable({topic.name, topic.title, topic.title_zh});
  for (const auto& name : topic.also) out += searchable({name});
  return out;
}

std::string all_text(const drive::Topic& topic) {
  auto out = haystack(topic) + searchable({topic.text, topic.text_zh, topic.note, topic.note_zh});
  for (const auto& row : topic.rows) {
    for (const auto& cell : row.cells) out += searchable({cell});
    out += searchable({row.text, row.text_zh});
  }
  return out;
}

}  // namespace

std::string_view name(Found found) {
  constexpr std::array<std::string_view, 10> kNames{"object", "parameter", "fault", "abort", "exit",
                                                    "name",   "value",     "row",   "title", "text"};
  return kNames.at(static_cast<std::size_t>(found));
}

TopicQuery::TopicQuery(std::string_view words, std::span<const drive::EverydayWords> everyday)
    : everyday_(everyday),
      whole_(trim(words)),
      subject_(trim(whole_.substr(0, whole_.find('=')))),
      key_(key_of(words)),
      words_(words, everyday) {
  if (const auto sign = whole_.find('='); sign != std::string::npos) {
    assigned_ = true;
    counted_ = folded(subject_);
    number_ = parse_signed(folded(std::string_view(whole_).substr(sign + 1)));
    return;
  }
  const auto& all = words_.all();
  if (all.size() < 2) return;
  number_ = parse_signed(all.back());
  for (std::size_t i = 0; i + 1 < all.size(); ++i) append(counted_, all[i], " ");
}

bool TopicQuery::names(std::string_view name) const { return !key_.empty() && key_of(name) == key_; }

bool TopicQuery::names_display(std::string_view shown) const {
  const auto key = display_key(shown);
  const bool telling = key.find_first_of("0123456789") != std::string::npos && key.front() >= 'a';
  return telling && key == display_key(whole_);
}

bool TopicQuery::names_topic(const drive::Topic& topic) const {
  return names(topic.name) ||
         std::any_of(topic.also.begin(), topic.also.end(), [&](const auto& name) { return names(name); });
}

bool TopicQuery::names_value(const drive::Topic& topic, const od::Dictionary* dictionary) const {
  if (!number_ || !topic.object || topic.value != number_) return false;
  if (is_object(counted_, *topic.object, dictionary)) return true;
  if (assigned_) return false;
  auto words = counted_;
  for (const std::string_view filler : {" method", " code", " number"})
    if (words.ends_with(filler)) words.resize(words.size() - filler.size());
  return is_called(topic.kind, counted_) || is_called(topic.kind, words);
}

/// Whether a cell of a topic that the words before name is the last word. A number is looked for among the
/// numbers of the rows, and in a column that these words call by its heading; of cables all cells are
/// quantities.
bool TopicQuery::is_counted(const drive::Topic& topic, std::size_t column, std::string_view cell,
                            std::size_t numbers) const {
  const auto& heading = topic.columns[column];
  const auto& word = words_.all().back();
  if (heading == "step") return false;  // What the words count are no steps.
  if (is_quantity(cell, word)) return true;
  if (cell == word && is_telling(word)) return true;
  if (is_marked_hex(word) && is_marked_hex(cell)) return is_number(cell, word);
  const bool quantities = topic.kind == "cable" || topic.kind == "wiring";
  const bool called =
      quantities || std::any_of(words_.all().begin(), words_.all().end() - 1, [&](const std::string& before) {
        return has_word(searchable(heading), before);
      });
  if (column != numbers && !(called && is_countable(heading))) return false;
  return is_number(cell, word) || (column == numbers && is_counted_by(cell, word));
}

/// Rows with a cell that is all that was typed, or, of a topic that the words before name, the last word.
std::vector<std::size_t> TopicQuery::rows_of(const drive::Topic& topic, bool counted) const {
  const bool telling = is_telling(key_);
  const bool counts = counted && !assigned_ && words_.all().size() > 1;
  const auto about = counts ? haystack(topic) + searchable(topic.kind) : std::string();
  const bool named = counts && std::all_of(words_.all().begin(), words_.all().end() - 1,
                                           [&](const std::string& word) { return has_word(about, word); });
  if (!telling && !named) return {};
  const auto numbers = number_column(topic);
  const bool steps = has_steps(topic);
  const auto is_meant = [&](const drive::TopicRow& row, std::size_t column) {
    const auto cell = folded(row.cells[column]);
    if (telling && (names(cell) || (column == numbers && !steps && is_hex_number(cell, key_)))) return true;
    return named && is_counted(topic, column, cell, numbers);
  };
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < topic.rows.size(); ++i)
    for (std::size_t column = 0; column < topic.columns.size(); ++column)
      if (is_meant(topic.rows[i], column)) {
        out.push_back(i);
        break;
      }
  return out;
}

std::optional<TopicMatch> TopicQuery::match_name(const drive::Topic& topic) const {
  if (names_topic(topic)) return TopicMatch{Found::name, {}};
  if (auto rows = rows_of(topic, false); !rows.empty()) return TopicMatch{Found::row, std::move(rows)};
  return std::nullopt;
}

std::optional<TopicMatch> TopicQuery::match(const drive::Topic& topic,
                                            const od::Dictionary* dictionary) const {
  if (names_topic(topic)) return TopicMatch{Found::name, {}};
  if (names_value(topic, dictionary)) return TopicMatch{Found::value, {}};
  if (auto rows = rows_of(topic, true); !rows.empty()) return TopicMatch{Found::row, std::move(rows)};
  if (words_.are_in(haystack(topic)) || names(topic.kind)) return TopicMatch{Found::title, {}};
  if (words_.are_in(all_text(topic))) return TopicMatch{Found::text, {}};
  return std::nullopt;
}

}  // namespace servoctl::show
