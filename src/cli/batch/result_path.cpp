#include "cli/batch/result_path.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"

namespace servoctl::cli {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::Table;
using report::Value;

tl::unexpected<Error> no_path(std::string_view path) {
  return fail(Errc::usage, message("'{}' leads nowhere", as_it_is(path)),
              "write [0].value, .state or .fault.code, with the names of --json");
}

/// What was kept as JSON, as values again.
Value opened(const Value& value) {
  const auto* kept = std::get_if<report::Written>(&value.data());
  return kept == nullptr ? value : report::parse_json(kept->json, "the result").value_or(value);
}

Record row_record(const Table& table, const List& row) {
  Record out;
  for (std::size_t i = 0; i < row.size(); ++i)
    out.push_back({table.columns[i].key, row[i], table.columns[i].show});
  return out;
}

const Value* field_of(const Record& record, std::string_view name) {
  for (const auto& field : record)
    if (field.key == name && field.show != Show::text) return &field.value;
  return nullptr;
}

Result<Part> take_field(const Part& from, const std::string& name) {
  const auto* record = std::get_if<Record>(&from.value.data());
  const auto said = from.where == "." ? std::string("the result") : from.where;
  if (record == nullptr) return fail(Errc::negative, message("{} has no field {}", said, as_it_is(name)));
  if (const auto* value = field_of(*record, name))
    return Part{(from.where == "." ? "" : from.where) + "." + name, opened(*value)};
  std::vector<std::string> names;
  for (const auto& field : *record)
    if (field.show != Show::text) names.push_back(field.key);
  return fail(Errc::negative, message("{} has no field {}", said, as_it_is(name)), "it has " + one_of(names));
}

std::string element_path(const std::string& list, std::size_t i) {
  return formatted("{}[{}]", list == "." ? "" : list, i);
}

Result<std::vector<Part>> take_step(const std::vector<Part>& from, const PathStep& step) {
  std::vector<Part> out;
  for (const auto& part : from) {
    const auto list = elements(part.value);
    if (step.element) {
      if (!list || *step.element >= list->size())
        return fail(
            Errc::negative,
            message("{} has no element {}", part.where == "." ? "the result" : part.where, *step.element),
            list ? message("it has {} entries", list->size()) : "it is not a list");
      out.push_back({element_path(part.where, *step.element), (*list)[*step.element]});
      continue;
    }
    const auto several = list ? *list : std::vector<Value>{part.value};
    for (std::size_t i = 0; i < several.size(); ++i) {
      auto field = take_field({list ? element_path(part.where, i) : part.where, several[i]}, step.field);
      if (!field) return fail(field.error());
      out.push_back(std::move(*field));
    }
  }
  if (out.empty()) return fail(Errc::negative, "the result is an empty list: nothing to compare");
  return out;
}

}  // namespace

Result<std::vector<PathStep>> parse_path(std::string_view path) {
  std::vector<PathStep> out;
  if (path == ".") return out;
  if (path.empty()) return no_path(path);
  for (std::size_t at = 0; at < path.size();) {
    if (path[at] == '[') {
      const auto end = path.find(']', at);
      if (end == std::string_view::npos) return no_path(path);
      const auto element = parse_digits(path.substr(at + 1, end - at - 1), 10);
      if (!element) return no_path(path);
      out.push_back({static_cast<std::size_t>(*element), {}});
      at = end + 1;
    } else {
      const auto end = std::min(path.find_first_of(".[", at + 1), path.size());
      if (path[at] != '.' || end == at + 1) return no_path(path);
      out.push_back({std::nullopt, std::string(path.substr(at + 1, end - at - 1))});
      at = end;
    }
  }
  return out;
}

Result<std::vector<Part>> follow(const Value& result, std::string_view path) {
  const auto steps = parse_path(path);
  if (!steps) return fail(steps.error());
  std::vector<Part> parts{{".", opened(result)}};
  for (const auto& step : *steps) {
    auto next = take_step(parts, step);
    if (!next) return next;
    parts = std::move(*next);
  }
  return parts;
}

std::optional<std::vector<Value>> elements(const Value& value) {
  if (const auto* list = std::get_if<List>(&value.data())) return *list;
  const auto* table = value.table();
  if (table == nullptr) return std::nullopt;
  if (!table->documents.empty()) return table->documents;
  std::vector<Value> out;
  for (const auto& row : table->rows) out.emplace_back(row_record(*table, row));
  return out;
}

std::optional<long double> number(const Value& value) {
  const auto& data = value.data();
  if (const auto* i = std::get_if<std::int64_t>(&data)) return static_cast<long double>(*i);
  if (const auto* u = std::get_if<std::uint64_t>(&data)) return static_cast<long double>(*u);
  if (const auto* d = std::get_if<double>(&data)) return static_cast<long double>(*d);
  if (const auto* h = std::get_if<report::Hex>(&data)) return static_cast<long double>(h->value);
  return std::nullopt;
}

std::string text(const Value& value) {
  if (const auto* s = std::get_if<std::string>(&value.data())) return *s;
  return report::to_json(value);
}

}  // namespace servoctl::cli
