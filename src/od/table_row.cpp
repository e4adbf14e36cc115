#include "od/table_row.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"

namespace servoctl::od {
namespace {

/// `0=Off;1=On` into pairs; empty optional when a part has no number or no label.
std::optional<std::vector<std::pair<std::int64_t, std::string>>> parse_labels(std::string_view text) {
  std::vector<std::pair<std::int64_t, std::string>> out;
  for (const auto part : split(text, ';')) {
    const auto equals = part.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    const auto value = parse_signed(trim(part.substr(0, equals)));
    const auto label = trim(part.substr(equals + 1));
    if (!value || label.empty() || label.find('=') != std::string_view::npos) return std::nullopt;
    out.emplace_back(*value, std::string(label));
  }
  return out;
}

}  // namespace

TableColumns TableColumns::find(const CsvTable& table, std::span<const std::string_view> known,
                                std::string_view file, std::vector<Error>& errors) {
  const std::vector<std::string> names(known.begin(), known.end());
  std::string quoted;
  for (const auto name : known) append(quoted, formatted("'{}'", name));
  for (const auto& column : table.columns) {
    if (std::find(known.begin(), known.end(), column) != known.end()) continue;
    auto hint = did_you_mean(column, names);
    if (hint.empty()) hint = "write one of " + quoted;
    errors.push_back(
        file_error(file, 1, message("column '{}' is unknown", as_it_is(column)), std::move(hint)));
  }
  TableColumns out;
  for (const auto name : known) out.places_.push_back(table.column(name));
  return out;
}

std::string_view TableRow::cell(std::size_t column) const {
  const auto place = columns_->place(column);
  return place < row_->cells.size() ? std::string_view(row_->cells[place]) : std::string_view();
}

void TableRow::refuse(std::size_t column, const Message& expected) {
  refuse(message("column '{}': '{}' is not {}", as_it_is(names_[column]), as_it_is(cell(column)), expected));
}

void TableRow::refuse(const Message& what, Message hint) {
  errors_.push_back(file_error(file_, row_->line, what, std::move(hint)));
}

std::optional<ObjectAddress> TableRow::object(std::size_t column) {
  const auto text = cell(column);
  if (text.empty()) return std::nullopt;
  const auto address = parse_object_address(text);
  if (!address) refuse(column, "an object such as 0x2000:01");
  return address;
}

double TableRow::scale(std::size_t column) {
  const auto text = cell(column);
  if (text.empty()) return 1;
  const auto number = parse_real(text);
  if (number && *number != 0) return *number;
  refuse(column, "a number other than zero");
  return {};
}

Encoding TableRow::encoding(std::size_t column) {
  const auto encoding = parse_encoding(cell(column));
  if (!encoding) refuse(column, "f32, f32hi or empty");
  return encoding.value_or(Encoding::plain);
}

Effect TableRow::effect(std::size_t column) {
  const auto effect = parse_effect(cell(column));
  if (!effect) refuse(column, "immediate, restart, standstill or empty");
  return effect.value_or(Effect::unstated);
}

std::optional<Value> TableRow::value(std::size_t column, DataType type) {
  const auto text = cell(column);
  if (text.empty()) return std::nullopt;
  const auto value = parse_value(type, text);
  if (!value) refuse(column, message("a value of {}: {}", as_it_is(name(type)), value.error().message));
  return value ? std::optional<Value>(*value) : std::nullopt;
}

std::vector<EnumLabel> TableRow::labels(std::size_t column, std::size_t column_zh) {
  const auto english = parse_labels(cell(column));
  const auto chinese = parse_labels(cell(column_zh));
  if (!english) refuse(column, "a list such as 0=Off;1=On");
  if (!chinese) refuse(column_zh, "a list such as 0=关;1=开");
  std::vector<EnumLabel> out;
  if (!english || !chinese) return out;
  for (const auto& label : *english) {
    if (std::any_of(out.begin(), out.end(), [&](const EnumLabel& e) { return e.value == label.first; }))
      refuse(column, message("a list without doubles ({} appears twice)", label.first));
    out.push_back({label.first, label.second, {}});
  }
  for (const auto& label : *chinese) {
    const auto same =
        std::find_if(out.begin(), out.end(), [&](const EnumLabel& e) { return e.value == label.first; });
    if (same == out.end())
      refuse(column_zh, message("a list with the values of the English one ({} is not in it)", label.first));
    else
      same->label_zh = label.second;
  }
  return out;
}

Doubts TableRow::doubts(std::size_t assumed, std::size_t contradicted) {
  constexpr std::string_view kForm = "a list such as default 938 3288;min: fields and lines of the manual";
  Doubts out;
  const auto read = [&](std::size_t column, std::vector<Mark>& marks) {
    auto parsed = parse_marks(cell(column));
    if (!parsed) return refuse(column, kForm);
    marks = std::move(*parsed);
  };
  read(assumed, out.assumed);
  read(contradicted, out.contradicted);
  for (const auto& mark : out.contradicted)
    if (mark.lines.empty()) refuse(contradicted, "a list with the lines of each contradiction");
  return out;
}

std::uint32_t TableRow::number(std::size_t column) {
  const auto text = cell(column);
  if (text.empty()) return 0;
  const auto number = parse_digits(text, 10);
  if (number && *number <= 0xFFFF'FFFFU) return static_cast<std::uint32_t>(*number);
  refuse(column, "a line number");
  return {};
}

}  // namespace servoctl::od
