#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/boxed.hpp"
#include "base/result.hpp"
#include "base/series.hpp"

namespace servoctl::report {

/// A number shown in hexadecimal as text and as a plain number in JSON.
struct Hex {
  std::uint64_t value = 0;
  int digits = 4;
};

/// Where a field is shown. Text is for reading, JSON carries everything.
enum class Show : std::uint8_t { everywhere, text, json };

/// What has been written as JSON already: samples, of which there may be millions. As text it is as in JSON.
struct Written {
  std::string json;
};

class Value;
struct Field;
using List = std::vector<Value>;
using Record = std::vector<Field>;  ///< Keeps the order in which it was written.

/// Rows with the same fields: columns in text, an array of objects in JSON. A column in which every cell is
/// empty is left out of the text.
struct Table {
  struct Column {
    std::string key;         ///< Name in JSON.
    std::string title = {};  ///< Heading in text; the key when empty.
    Show show = Show::everywhere;
  };
  std::vector<Column> columns;
  std::vector<List> rows;
  bool json_only = false;               ///< Nothing in it is worth reading: the errors say it all.
  std::vector<std::string> below = {};  ///< Lines that stand under it, in text only.
  bool below_told = false;              ///< They are in the language of who reads already.
  List documents;                       ///< One for each row, where JSON tells more than cells do.
};

/// Quantities over time: a plot in text and on a page, `[{"name","unit","seconds","values"}]` in JSON.
struct Plot {
  std::vector<Series> series;
};

/// What a command says. Commands build it; only report/text.cpp, report/json.cpp and report/html.cpp turn it
/// into characters.
class Value {
 public:
  /// The two that are large and few are elsewhere: of most values there are tens of thousands.
  using Data = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, Hex, List,
                            Record, Boxed<Table>, Boxed<Plot>, Written>;
  // Defined where Field is complete.
  Value();
  Value(const Value&);
  Value(Value&&) noexcept;
  Value& operator=(const Value&);
  Value& operator=(Value&&) noexcept;
  ~Value();

  // NOLINTBEGIN(google-explicit-constructor)
  Value(const char* text);
  Value(std::string_view text);
  Value(std::string text);
  Value(double number);
  Value(Hex number);
  Value(List list);
  Value(Record record);
  Value(Table table);
  Value(Plot plot);
  Value(Written json);
  template <class T>
  requires std::is_integral_v<T> Value(T number);
  // NOLINTEND(google-explicit-constructor)

  const Data& data() const { return data_; }
  Data& data() { return data_; }
  /// Null where it is something else.
  const Table* table() const;
  Table* table();
  const Plot* plot() const;
  Plot* plot();
  bool is_null() const { return std::holds_alternative<std::monostate>(data_); }
  bool is_number() const {
    return std::holds_alternative<std::int64_t>(data_) || std::holds_alternative<std::uint64_t>(data_) ||
           std::holds_alternative<double>(data_);
  }

 private:
  Data data_;
};

struct Field {
  std::string key;
  Value value = {};
  Show show = Show::everywhere;
  std::string title = {};  ///< Heading in text; the key when empty.
};

template <class T>
requires std::is_integral_v<T> Value::Value(T number) {
  if constexpr (std::is_same_v<T, bool>)
    data_ = number;
  else if constexpr (std::is_signed_v<T>)
    data_ = static_cast<std::int64_t>(number);
  else
    data_ = static_cast<std::uint64_t>(number);
}

/// A text, or nothing when it is empty.
inline Value text_or_null(std::string text) { return text.empty() ? Value() : Value(std::move(text)); }

/// The value as people read it, in at most `width` columns (0: no limit). Ends with a line break unless
/// empty.
std::string to_text(const Value& value, std::size_t width = 0);

/// The value as one JSON document in one line, without line break.
std::string to_json(const Value& value);

/// Reads one JSON document. Errc::file with the line where it goes wrong; `file` is used in messages.
Result<Value> parse_json(std::string_view text, std::string_view file);

/// The quantities in a Plot, or in what parse_json() makes of one. Errc::file when it is neither.
Result<Plot> plot_of(const Value& value);

/// The field of a record, or null.
const Value* find(const Value& record, std::string_view key);

}  // namespace servoctl::report
