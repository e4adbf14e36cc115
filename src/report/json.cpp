#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/format.hpp"
#include "base/utf8.hpp"
#include "report/json_writer.hpp"
#include "report/value.hpp"

namespace servoctl::report {
namespace {

using Json = nlohmann::ordered_json;

/// Bytes that stand in JSON as they are, whatever stands beside them.
constexpr auto kPlain = [] {
  std::array<bool, 256> out{};
  for (std::size_t byte = 0x20; byte < 0x7F; ++byte) out[byte] = byte != '"' && byte != '\\';
  return out;
}();

bool is_plain(char c) { return kPlain[static_cast<unsigned char>(c)]; }

void append_unit(std::uint32_t unit, std::string& out) {
  fmt::format_to(std::back_inserter(out), "\\u{:04x}", unit);
}

/// The first character of the text, and how many bytes it took. What would move a cursor or hide on a
/// terminal is the same character, written as an escape; a byte that is no UTF-8 becomes U+FFFD.
std::size_t append_escaped(std::string_view text, std::string& out) {
  switch (text.front()) {
    case '"': out += "\\\""; return 1;
    case '\\': out += "\\\\"; return 1;
    case '\b': out += "\\b"; return 1;
    case '\f': out += "\\f"; return 1;
    case '\n': out += "\\n"; return 1;
    case '\r': out += "\\r"; return 1;
    case '\t': out += "\\t"; return 1;
    default: break;
  }
  const auto c = decode_utf8(text);
  if (!c.value || !is_hidden_or_control(*c.value)) {
    out += text.substr(0, c.size);
  } else if (*c.value <= 0xFFFF) {
    append_unit(*c.value, out);
  } else {
    append_unit(0xD7C0U + (*c.value >> 10U), out);
    append_unit(0xDC00U + (*c.value & 0x3FFU), out);
  }
  return c.size;
}

/// In UTF-8: what is none becomes U+FFFD.
std::string mended(std::string_view text) {
  return Json::parse(Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace))
      .get<std::string>();
}

/// Writes a value by its kind.
struct ToJson {
  JsonWriter& json;

  void operator()(std::monostate) const { json.null(); }
  void operator()(const Hex& h) const { json.value(h.value); }
  void operator()(const Written& w) const { json.written(w.json); }
  template <class T>
  void operator()(const T& scalar) const {
    json.value(scalar);
  }
  template <class T>
  void operator()(const Boxed<T>& boxed) const {
    boxed.get() != nullptr ? (*this)(*boxed.get()) : json.null();
  }
  void operator()(const List& l) const {
    json.begin_list();
    for (const auto& v : l) json.value(v);
    json.end_list();
  }
  void operator()(const Record& r) const {
    json.begin_record();
    for (const auto& field : r) member(field.key, field.value, field.show);
    json.end_record();
  }
  void operator()(const Table& t) const {
    if (!t.documents.empty()) return (*this)(t.documents);
    json.begin_list();
    for (const auto& row : t.rows) {
      json.begin_record();
      for (std::size_t i = 0; i < row.size(); ++i) member(t.columns[i].key, row[i], t.columns[i].show);
      json.end_record();
    }
    json.end_list();
  }
  void operator()(const Plot& p) const {
    json.begin_list();
    for (const auto& series : p.series) {
      json.begin_record();
      json.member("name", series.name);
      json.text_or_null("unit", series.unit);
      numbers("seconds", series.seconds);
      numbers("values", series.values);
      json.end_record();
    }
    json.end_list();
  }

 private:
  void member(std::string_view key, const Value& value, Show show) const {
    if (show == Show::text) return;
    json.key(key);
    json.value(value);
  }
  void numbers(std::string_view key, const std::vector<double>& all) const {
    json.key(key);
    json.begin_list();
    for (const double number : all) json.value(number);
    json.end_list();
  }
};

}  // namespace

void JsonWriter::begin(char first) {
  if (needs_comma()) *out_ += ',';
  *out_ += first;
}

void JsonWriter::written(std::string_view json) {
  if (json.empty()) return;
  if (needs_comma()) *out_ += ',';
  *out_ += json;
}

void JsonWriter::key(std::string_view key) {
  value(key);
  *out_ += ':';
}

void JsonWriter::integer(std::int64_t number) {
  const fmt::format_int digits(number);
  written({digits.data(), digits.size()});
}

void JsonWriter::natural(std::uint64_t number) {
  const fmt::format_int digits(number);
  written({digits.data(), digits.size()});
}

void JsonWriter::value(double number) {
  constexpr double kMostWhole = 9.0e15;  // Beyond it not every whole number is a double.
  if (!std::isfinite(number)) return null();
  if (number == std::floor(number) && std::abs(number) < kMostWhole)
    return integer(static_cast<std::int64_t>(number));
  std::array<char, 64> digits;
  const auto* end = nlohmann::detail::to_chars(digits.data(), digits.data() + digits.size(), number);
  written({digits.data(), static_cast<std::size_t>(end - digits.data())});
}

void JsonWriter::value(std::string_view text) {
  if (std::all_of(text.begin(), text.end(), is_plain)) return quoted(text, "\"");
  if (!is_utf8(text)) return value(mended(text));
  begin('"');
  while (!text.empty()) text.remove_prefix(append_escaped(text, *out_));
  *out_ += '"';
}

/// In one go: most of the time of a writer is spent here.
void JsonWriter::quoted(std::string_view text, std::string_view end) {
  const bool comma = needs_comma();
  const auto size = out_->size();
  out_->resize(size + (comma ? 2 : 1) + text.size() + end.size());
  auto* at = out_->data() + size;
  if (comma) *at++ = ',';
  *at++ = '"';
  std::copy(end.begin(), end.end(), std::copy(text.begin(), text.end(), at));
}

void JsonWriter::write(const Value& tree) { std::visit(ToJson{*this}, tree.data()); }

std::string to_json(const Value& value) {
  std::string out;
  JsonWriter(out).value(value);
  return out;
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

/// More lists and records than this stand in each other in no file of ours.
constexpr std::size_t kDeepestJson = 64;

/// Where more lists and records stand in each other than any file of ours has; empty when nowhere. What
/// reads, copies and destroys the tree calls itself once a level.
std::optional<std::size_t> too_deep(std::string_view text) {
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"') {
      quoted = !quoted;
    } else if (quoted) {
      at += c == '\\' ? 1 : 0;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestJson) return at;
    } else if (c == ']' || c == '}') {
      depth -= depth > 0 ? 1 : 0;
    }
  }
  return std::nullopt;
}

std::uint32_t line_at(std::string_view text, std::size_t place) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(text.size(), place));
  return static_cast<std::uint32_t>(1 + std::count(text.begin(), end, '\n'));
}

tl::unexpected<Error> nested_too_deep(std::string_view text, std::size_t place, std::string_view file) {
  const auto line = line_at(text, place);
  const auto begin = text.substr(0, place).rfind('\n');
  auto error =
      fail(Errc::file,
           message("{}:{}: column {}: lists and records are nested deeper than {} levels", as_it_is(file),
                   line, begin == std::string_view::npos ? place + 1 : place - begin, kDeepestJson),
           "servoctl writes no such file: is it the right one?")
          .value();
  error.line = line;
  return fail(std::move(error));
}

}  // namespace

Result<Value> parse_json(std::string_view text, std::string_view file) {
  if (const auto place = too_deep(text)) return nested_too_deep(text, *place, file);
  try {
    return FromJson::value(Json::parse(text));
  } catch (const Json::parse_error& problem) {
    return fail(file_error(file, line_at(text, problem.byte), "not JSON, or truncated"));
  } catch (const Json::exception& problem) {
    return fail(Errc::file, message("{}: {}", as_it_is(file), problem.what()));
  }
}

const Value* find(const Value& record, std::string_view key) {
  const auto* fields = std::get_if<Record>(&record.data());
  if (fields == nullptr) return nullptr;
  for (const auto& field : *fields)
    if (field.key == key) return &field.value;
  return nullptr;
}

}  // namespace servoctl::report
