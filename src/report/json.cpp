#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "report/value.hpp"

namespace servoctl::report {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Value& value);

struct ToJson {
  Json operator()(std::monostate) const { return nullptr; }
  Json operator()(bool b) const { return b; }
  Json operator()(std::int64_t i) const { return i; }
  Json operator()(std::uint64_t u) const { return u; }
  Json operator()(double d) const {
    // A whole number is written without ".0", so that 40 Hz reads 40 as in text.
    if (d == std::floor(d) && std::abs(d) < 9.0e15) return static_cast<std::int64_t>(d);
    return d;
  }
  Json operator()(const std::string& s) const { return s; }
  Json operator()(const Hex& h) const { return h.value; }
  Json operator()(const List& l) const {
    Json out = Json::array();
    for (const auto& v : l) out.push_back(json(v));
    return out;
  }
  Json operator()(const Record& r) const {
    Json out = Json::object();
    for (const auto& field : r)
      if (field.show != Show::text) out[field.key] = json(field.value);
    return out;
  }
  Json operator()(const Table& t) const {
    Json out = Json::array();
    for (const auto& row : t.rows) {
      Json object = Json::object();
      for (std::size_t i = 0; i < row.size(); ++i)
        if (t.columns[i].show != Show::text) object[t.columns[i].key] = json(row[i]);
      out.push_back(std::move(object));
    }
    return out;
  }
  Json operator()(const Plot& p) const {
    Json out = Json::array();
    for (const auto& series : p.series)
      out.push_back({{"name", series.name},
                     {"unit", series.unit.empty() ? Json() : Json(series.unit)},
                     {"seconds", numbers(series.seconds)},
                     {"values", numbers(series.values)}});
    return out;
  }

 private:
  Json numbers(const std::vector<double>& all) const {
    Json out = Json::array();
    for (const double number : all) out.push_back(std::isfinite(number) ? (*this)(number) : Json());
    return out;
  }
};

Json json(const Value& value) { return std::visit(ToJson{}, value.data()); }

}  // namespace

std::string to_json(const Value& value) {
  // Names come from files and drives: a byte that is no UTF-8 becomes U+FFFD instead of an exception.
  return json(value).dump(-1, ' ', false, Json::error_handler_t::replace);
}

namespace {

struct FromJson {
  static Value value(const Json& j) {
    switch (j.type()) {
      case Json::value_t::boolean: return j.get<bool>();
      case Json::value_t::number_integer: return j.get<std::int64_t>();
      case Json::value_t::number_unsigned: return j.get<std::uint64_t>();
      case Json::value_t::number_float: return j.get<double>();
      case Json::value_t::string: return j.get<std::string>();
      case Json::value_t::array: {
        List out;
        for (const auto& element : j) out.push_back(value(element));
        return out;
      }
      case Json::value_t::object: {
        Record out;
        for (const auto& [key, element] : j.items()) out.push_back({key, value(element)});
        return out;
      }
      default: return {};
    }
  }
};

}  // namespace

Result<Value> parse_json(std::string_view text, std::string_view file) {
  try {
    return FromJson::value(Json::parse(text));
  } catch (const Json::parse_error& problem) {
    Error error;
    error.code = Errc::file;
    const auto end = std::min(text.size(), problem.byte);
    error.line = static_cast<std::uint32_t>(
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    error.message = fmt::format("{}:{}: this is no JSON, or it ends too early", file, *error.line);
    return fail(std::move(error));
  } catch (const Json::exception& problem) {
    return fail(Errc::file, fmt::format("{}: {}", file, problem.what()));
  }
}

namespace {

std::optional<double> number(const Value& value) {
  const auto& data = value.data();
  if (const auto* i = std::get_if<std::int64_t>(&data)) return static_cast<double>(*i);
  if (const auto* u = std::get_if<std::uint64_t>(&data)) return static_cast<double>(*u);
  if (const auto* d = std::get_if<double>(&data)) return *d;
  return value.is_null() ? std::optional(std::numeric_limits<double>::quiet_NaN()) : std::nullopt;
}

/// Empty when it is no list of numbers.
std::optional<std::vector<double>> numbers(const Value* value) {
  const auto* list = value == nullptr ? nullptr : std::get_if<List>(&value->data());
  if (list == nullptr) return std::nullopt;
  std::vector<double> out;
  for (const auto& element : *list) {
    const auto one = number(element);
    if (!one) return std::nullopt;
    out.push_back(*one);
  }
  return out;
}

std::string text(const Value* value) {
  const auto* found = value == nullptr ? nullptr : std::get_if<std::string>(&value->data());
  return found == nullptr ? std::string() : *found;
}

}  // namespace

Result<Plot> plot_of(const Value& value) {
  if (const auto* plot = std::get_if<Plot>(&value.data())) return *plot;
  const auto* list = std::get_if<List>(&value.data());
  Plot out;
  for (const auto& one : list == nullptr ? List{Value()} : *list) {
    auto seconds = numbers(find(one, "seconds"));
    auto values = numbers(find(one, "values"));
    if (!seconds || !values || seconds->size() != values->size())
      return fail(Errc::file, "these are no samples: each quantity has as many seconds as values");
    out.series.push_back(
        {text(find(one, "name")), text(find(one, "unit")), std::move(*seconds), std::move(*values)});
  }
  return out;
}

const Value* find(const Value& record, std::string_view key) {
  const auto* fields = std::get_if<Record>(&record.data());
  if (fields == nullptr) return nullptr;
  for (const auto& field : *fields)
    if (field.key == key) return &field.value;
  return nullptr;
}

}  // namespace servoctl::report
