#include "report/value.hpp"

#include <limits>
#include <optional>

namespace servoctl::report {

Value::Value() = default;
Value::Value(const Value&) = default;
Value::Value(Value&&) noexcept = default;
Value& Value::operator=(const Value&) = default;
Value& Value::operator=(Value&&) noexcept = default;
Value::~Value() = default;

Value::Value(const char* text) : data_(std::string(text)) {}
Value::Value(std::string_view text) : data_(std::string(text)) {}
Value::Value(std::string text) : data_(std::move(text)) {}
Value::Value(double number) : data_(number) {}
Value::Value(Hex number) : data_(number) {}
Value::Value(List list) : data_(std::move(list)) {}
Value::Value(Record record) : data_(std::move(record)) {}
Value::Value(Table table) : data_(Boxed(std::move(table))) {}
Value::Value(Plot plot) : data_(Boxed(std::move(plot))) {}
Value::Value(Written json) : data_(std::move(json)) {}

namespace {

template <class T, class Data>
auto* unboxed(Data& data) {
  auto* box = std::get_if<Boxed<T>>(&data);
  return box == nullptr ? nullptr : box->get();
}

}  // namespace

const Table* Value::table() const { return unboxed<Table>(data_); }
Table* Value::table() { return unboxed<Table>(data_); }
const Plot* Value::plot() const { return unboxed<Plot>(data_); }
Plot* Value::plot() { return unboxed<Plot>(data_); }

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
  if (const auto* plot = value.plot()) return *plot;
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

}  // namespace servoctl::report
