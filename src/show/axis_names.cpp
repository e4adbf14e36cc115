#include "show/axis_names.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <variant>

#include "base/number.hpp"
#include "base/utf8.hpp"

namespace servoctl::show {
namespace {

using report::List;
using report::Record;
using report::Table;
using report::Value;

constexpr std::string_view kNode = "node";
constexpr std::string_view kAxis = "axis";

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-'; }

std::optional<std::uint8_t> node_in(const Value& value) {
  std::optional<std::uint64_t> number;
  if (const auto* whole = std::get_if<std::uint64_t>(&value.data())) number = *whole;
  if (const auto* whole = std::get_if<std::int64_t>(&value.data()); whole != nullptr && *whole >= 0)
    number = static_cast<std::uint64_t>(*whole);
  return number && *number <= 127 ? std::optional(static_cast<std::uint8_t>(*number)) : std::nullopt;
}

/// The number that begins here; empty where none does, or it is part of something else (`3.5`, `0x10`).
std::string_view digits_at(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  const bool more = end < text.size() && is_word(text[end]) && text[end] != '-';
  const bool decimal = end + 1 < text.size() && text[end] == '.' && is_digit(text[end + 1]);
  return more || decimal ? std::string_view() : text.substr(0, end);
}

/// What stands before a list of node numbers in sentences, and whether it goes when the first has a name.
struct Lead {
  std::string_view word;
  bool goes = true;
};
constexpr Lead kLeads[] = {{"nodes "}, {"node "}, {"Nodes "}, {"Node "}, {"节点 "}, {"-n ", false}};

const Lead* lead_at(std::string_view text, std::size_t at) {
  if (at > 0 && is_word(text[at - 1])) return nullptr;
  for (const auto& lead : kLeads)
    if (text.substr(at).starts_with(lead.word)) return &lead;
  return nullptr;
}

/// What stands between two numbers of such a list; 0 characters where the list ends.
std::size_t joint_at(std::string_view text) {
  for (const std::string_view joint : {", ", ",", " and ", " or ", "、", "，", " 和 ", " 或 "})
    if (text.starts_with(joint) && !digits_at(text.substr(joint.size())).empty()) return joint.size();
  return 0;
}

}  // namespace

std::string_view AxisNames::of(std::uint8_t node) const {
  const auto found = names_.find(node);
  return found == names_.end() ? std::string_view() : std::string_view(found->second);
}

std::string AxisNames::in(std::string_view text) const {
  std::string out;
  const auto name_of = [this](std::string_view digits) {
    const auto number = parse_digits(digits, 10);
    return number && *number <= 127 ? of(static_cast<std::uint8_t>(*number)) : std::string_view();
  };
  for (std::size_t at = 0; at < text.size();) {
    const auto* lead = lead_at(text, at);
    auto digits = lead == nullptr ? std::string_view() : digits_at(text.substr(at + lead->word.size()));
    if (digits.empty() || name_of(digits).empty()) {
      out += text[at++];
      continue;
    }
    if (!lead->goes) out += lead->word;
    // Between Chinese and a name stands a blank, as between Chinese and the number.
    if (lead->goes && ends_with_character(out)) out += ' ';
    at += lead->word.size();
    while (!digits.empty()) {
      const auto name = name_of(digits);
      out += name.empty() ? digits : name;
      at += digits.size();
      const auto joint = joint_at(text.substr(at));
      out += text.substr(at, joint);
      at += joint;
      digits = joint == 0 ? std::string_view() : digits_at(text.substr(at));
    }
  }
  return out;
}

void AxisNames::put_into(Record& record) const {
  if (empty()) return;
  for (auto& field : record) put_into(field.value);
  const auto has = [&](std::string_view key) {
    return std::find_if(record.begin(), record.end(), [&](const auto& f) { return f.key == key; });
  };
  const auto node = has(kNode);
  const auto axis = has(kAxis);
  if (node == record.end() || (axis != record.end() && !axis->value.is_null())) return;
  const auto number = node_in(node->value);
  const auto name = number ? of(*number) : std::string_view();
  if (name.empty()) return;
  if (axis != record.end())
    axis->value = name;
  else
    record.insert(node, {std::string(kAxis), name, node->show, {}});
}

void AxisNames::put_into(Value& value) const {
  if (empty()) return;
  if (auto* record = std::get_if<Record>(&value.data())) return put_into(*record);
  if (auto* list = std::get_if<List>(&value.data()))
    for (auto& one : *list) put_into(one);
  auto* table = value.table();
  if (table == nullptr) return;
  for (auto& row : table->rows)
    for (auto& cell : row) put_into(cell);
  for (auto& document : table->documents) put_into(document);
  const auto is = [](std::string_view key) {
    return [key](const Table::Column& column) { return column.key == key; };
  };
  const auto node = std::find_if(table->columns.begin(), table->columns.end(), is(kNode));
  if (node == table->columns.end() || std::any_of(table->columns.begin(), table->columns.end(), is(kAxis)))
    return;
  const auto at = node - table->columns.begin();
  for (auto& row : table->rows) {
    const auto number = node_in(row[static_cast<std::size_t>(at)]);
    row.insert(row.begin() + at, report::text_or_null(std::string(number ? of(*number) : "")));
  }
  table->columns.insert(node, {std::string(kAxis), {}, node->show});
}

void AxisNames::put_into(Message& message) const {
  if (empty()) return;
  const auto name = [this](Message::Argument& argument) {
    if (auto* text = std::get_if<std::string>(&argument)) *text = in(std::string_view(*text));
    auto* nodes = std::get_if<Nodes>(&argument);
    // A notice of another bus has its names already.
    if (nodes == nullptr || !nodes->names.empty()) return;
    for (const auto node : nodes->numbers) nodes->names.emplace_back(of(node));
  };
  message = message.changed([](std::string_view literal) { return literal; }, name);
}

std::string AxisNames::sentence(Message message) const {
  put_into(message);
  return message.text();
}

}  // namespace servoctl::show
