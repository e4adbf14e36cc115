#include "gateway/value.hpp"

#include <fmt/format.h>
#include <array>

#include "base/base64.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "gateway/words.hpp"
#include "od/value.hpp"

namespace servoctl::gateway {
namespace {

using od::DataType;
using Form = ValueType::Form;

struct TypeName {
  std::string_view name;
  ValueType type;
};

constexpr std::array kTypes{
    TypeName{"b", {Form::number, DataType::boolean}},   TypeName{"i8", {Form::number, DataType::i8}},
    TypeName{"i16", {Form::number, DataType::i16}},     TypeName{"i24", {Form::number, DataType::i24}},
    TypeName{"i32", {Form::number, DataType::i32}},     TypeName{"i40", {Form::number, DataType::i40}},
    TypeName{"i48", {Form::number, DataType::i48}},     TypeName{"i56", {Form::number, DataType::i56}},
    TypeName{"i64", {Form::number, DataType::i64}},     TypeName{"u8", {Form::number, DataType::u8}},
    TypeName{"u16", {Form::number, DataType::u16}},     TypeName{"u24", {Form::number, DataType::u24}},
    TypeName{"u32", {Form::number, DataType::u32}},     TypeName{"u40", {Form::number, DataType::u40}},
    TypeName{"u48", {Form::number, DataType::u48}},     TypeName{"u56", {Form::number, DataType::u56}},
    TypeName{"u64", {Form::number, DataType::u64}},     TypeName{"r32", {Form::number, DataType::f32}},
    TypeName{"r64", {Form::number, DataType::f64}},     TypeName{"x8", {Form::hex_number, DataType::u8}},
    TypeName{"x16", {Form::hex_number, DataType::u16}}, TypeName{"x32", {Form::hex_number, DataType::u32}},
    TypeName{"x64", {Form::hex_number, DataType::u64}}, TypeName{"vs", {Form::text, DataType::string}},
    TypeName{"os", {Form::base64, DataType::bytes}},    TypeName{"us", {Form::base64, DataType::bytes}},
    TypeName{"d", {Form::base64, DataType::domain}},    TypeName{"t", {Form::time, DataType::time}},
    TypeName{"td", {Form::time, DataType::time}},       TypeName{"hex", {Form::hex, DataType::domain}},
};

/// Milliseconds are 28 bits, days 16 (CiA 301, 7.1.6.6 and 7.1.6.7).
constexpr std::uint64_t kMostMilliseconds = 0x0FFF'FFFF;
constexpr std::uint64_t kMostDays = 0xFFFF;

tl::unexpected<Error> no_value(std::string_view words) {
  return fail(Errc::usage, message("'{}' is not a value of this type", as_it_is(words)));
}

Result<Bytes> parse_time(std::span<const std::string> words) {
  const auto days = words.size() == 2 ? parse_digits(words[0], 10) : std::nullopt;
  const auto ms = words.size() == 2 ? parse_digits(words[1], 10) : std::nullopt;
  if (!days || *days > kMostDays || !ms || *ms > kMostMilliseconds)
    return no_value(formatted("{}", fmt::join(words, " ")));
  return store_le(*ms | *days << 32U, 6);
}

Result<Bytes> parse_hex(std::span<const std::string> words) {
  Bytes out;
  for (const auto& word : words) {
    // A single digit is a byte of its own.
    const auto bytes = parse_hex_bytes(word.size() == 1 ? "0" + word : word);
    if (!bytes) return no_value(word);
    out.insert(out.end(), bytes->begin(), bytes->end());
  }
  return out;
}

Result<Bytes> parse_number(DataType type, const std::string& word) {
  // Only what is a number on the line: no word, no `64h`, no `hex:`.
  const bool number = od::is_real(type)
                          ? parse_real(word).has_value()
                          : parse_integer(word).has_value() && word.find_first_of("hH") == std::string::npos;
  if (!number) return no_value(word);
  if (type == DataType::boolean) type = DataType::u8;
  const auto value = od::parse_value(type, word);
  if (!value) return fail(value.error());
  return od::encode(type, *value);
}

Result<Bytes> bytes_of(ValueType type, std::span<const std::string> words) {
  if (type.form == Form::hex) return parse_hex(words);
  if (type.form == Form::time) return parse_time(words);
  if (words.size() != 1) return no_value(formatted("{}", fmt::join(words, " ")));
  const auto& word = words.front();
  if (type.form == Form::text) return Bytes(word.begin(), word.end());
  if (type.form != Form::base64) return parse_number(type.type, word);
  auto bytes = parse_base64(word);
  if (!bytes) return no_value(word);
  return std::move(*bytes);
}

}  // namespace

std::optional<ValueType> parse_value_type(std::string_view name) {
  const auto wanted = lower(name);
  for (const auto& known : kTypes)
    if (known.name == wanted) return known.type;
  return std::nullopt;
}

Result<Bytes> parse_value(ValueType type, std::span<const std::string> words) {
  auto out = bytes_of(type, words);
  if (out && out->empty()) return fail(Errc::usage, "there is no value");
  return out;
}

std::string value_text(ValueType type, ByteSpan bytes) {
  if (type.form == Form::text) return in_quotes(std::string(bytes.begin(), bytes.end()));
  if (type.form == Form::base64) return to_base64(bytes);
  if (type.form == Form::hex || bytes.size() != od::size_of(type.type)) return to_hex(bytes);
  const auto raw = load_le(bytes);
  if (type.form == Form::hex_number) return formatted("0x{:0{}X}", raw, 2 * bytes.size());
  if (type.form == Form::time) return formatted("{} {}", raw >> 32U, raw & kMostMilliseconds);
  if (type.type == DataType::boolean) return std::to_string(raw);
  const auto value = od::decode(type.type, bytes);
  if (!value) return to_hex(bytes);
  // As many digits as tell it from its neighbours, and no more.
  if (type.type == DataType::f32) return formatted("{}", static_cast<float>(od::to_double(*value)));
  return od::to_string(*value);
}

}  // namespace servoctl::gateway
