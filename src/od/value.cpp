#include "od/value.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::od {
namespace {

/// 1..64; types without a fixed size do not come here.
std::size_t bits_of(DataType type) {
  return type == DataType::boolean ? 1 : 8 * std::clamp<std::size_t>(size_of(type).value_or(8), 1, 8);
}

std::uint64_t max_unsigned(DataType type) {
  const auto bits = bits_of(type);
  return bits >= 64 ? std::numeric_limits<std::uint64_t>::max() : (std::uint64_t{1} << bits) - 1;
}

std::int64_t max_signed(DataType type) { return static_cast<std::int64_t>(max_unsigned(type) >> 1U); }

std::int64_t min_signed(DataType type) { return -max_signed(type) - 1; }

std::string range_of(DataType type) {
  if (is_signed(type)) return formatted("{}..{}", min_signed(type), max_signed(type));
  return formatted("0..{}", max_unsigned(type));
}

tl::unexpected<Error> does_not_fit(DataType type, std::string_view text) {
  if (is_integer(type))
    return fail(Errc::usage, message("{} does not fit {} ({})", text, as_it_is(name(type)), range_of(type)));
  return fail(Errc::usage, message("'{}' does not fit {}", as_it_is(text), as_it_is(name(type))));
}

tl::unexpected<Error> not_a_value(DataType type, std::string_view text) {
  if (is_integer(type))
    return fail(Errc::usage, message("'{}' is not a number", as_it_is(text)),
                message("write an integer ({}): 100, 0x64 or 64h", range_of(type)));
  return fail(Errc::usage, message("'{}' is no {}", as_it_is(text), as_it_is(name(type))));
}

bool is_hexadecimal(std::string_view text) {
  return starts_with_nocase(text, "0x") || (!text.empty() && (text.back() == 'h' || text.back() == 'H'));
}

std::int64_t sign_extended(std::uint64_t raw, std::size_t bits) {
  const auto shift = 64 - bits;
  return static_cast<std::int64_t>(raw << shift) >> shift;
}

/// The double whose digits are those of the float: 0.1f becomes 0.1, not 0.10000000149; encoded again it is
/// the same float.
double shortest(float value) {
  return std::isfinite(value) ? parse_real(formatted("{}", value)).value_or(value)
                              : static_cast<double>(value);
}

Result<Value> parse_integer_value(DataType type, std::string_view text) {
  if (type == DataType::boolean && (equals_nocase(text, "true") || equals_nocase(text, "false")))
    return Value(std::uint64_t{equals_nocase(text, "true") ? 1U : 0U});
  const auto number = parse_integer(text);
  if (!number) return not_a_value(type, text);
  if (!is_signed(type)) {
    const auto value = number->as_unsigned();
    if (!value || *value > max_unsigned(type)) return does_not_fit(type, text);
    return Value(*value);
  }
  if (!number->negative && is_hexadecimal(text) && number->magnitude <= max_unsigned(type))
    return Value(sign_extended(number->magnitude, bits_of(type)));
  const auto value = number->as_signed();
  if (!value || *value < min_signed(type) || *value > max_signed(type)) return does_not_fit(type, text);
  return Value(*value);
}

Result<Value> parse_bytes_value(DataType type, std::string_view text) {
  auto digits = starts_with_nocase(text, "hex:") ? text.substr(4) : text;
  auto bytes = parse_hex_bytes(digits);
  if (!bytes)
    return fail(Errc::usage, message("'{}' is no {}", as_it_is(text), as_it_is(name(type))),
                "write bytes as hex:00 64 FF");
  return Value(std::move(*bytes));
}

Result<Bytes> encode_number(DataType type, const Value& value) {
  const auto size = size_of(type).value_or(0);
  if (is_signed(type)) {
    std::int64_t number = 0;
    if (const auto* i = std::get_if<std::int64_t>(&value))
      number = *i;
    else if (const auto* u = std::get_if<std::uint64_t>(&value);
             u != nullptr && *u <= static_cast<std::uint64_t>(max_signed(type)))
      number = static_cast<std::int64_t>(*u);
    else
      return does_not_fit(type, to_string(value));
    if (number < min_signed(type) || number > max_signed(type)) return does_not_fit(type, to_string(value));
    return store_le(static_cast<std::uint64_t>(number), size);
  }
  std::uint64_t number = 0;
  if (const auto* u = std::get_if<std::uint64_t>(&value))
    number = *u;
  else if (const auto* i = std::get_if<std::int64_t>(&value); i != nullptr && *i >= 0)
    number = static_cast<std::uint64_t>(*i);
  else
    return does_not_fit(type, to_string(value));
  if (number > max_unsigned(type)) return does_not_fit(type, to_string(value));
  return store_le(number, size);
}

}  // namespace

Result<Bytes> encode(DataType type, const Value& value) {
  if (is_integer(type)) return encode_number(type, value);
  if (is_real(type)) {
    if (std::holds_alternative<std::string>(value) || std::holds_alternative<Bytes>(value))
      return does_not_fit(type, to_string(value));
    const double number = to_double(value);
    if (type == DataType::f64) return store_le(std::bit_cast<std::uint64_t>(number), 8);
    const auto narrow = static_cast<float>(number);
    if (std::isinf(narrow) && !std::isinf(number)) return does_not_fit(type, to_string(value));
    return store_le(std::bit_cast<std::uint32_t>(narrow), 4);
  }
  if (const auto* text = std::get_if<std::string>(&value); text != nullptr && type == DataType::string)
    return Bytes(text->begin(), text->end());
  if (const auto* bytes = std::get_if<Bytes>(&value)) {
    const auto size = size_of(type);
    if (size && bytes->size() != *size)
      return fail(Errc::usage,
                  message("{} bytes do not fit {} ({} bytes)", bytes->size(), as_it_is(name(type)), *size));
    return *bytes;
  }
  return does_not_fit(type, to_string(value));
}

Result<Value> decode(DataType type, ByteSpan bytes) {
  const auto size = size_of(type);
  if (size && bytes.size() != *size)
    return fail(Errc::protocol,
                message("{} bytes received, {} has {}", bytes.size(), as_it_is(name(type)), *size),
                "the dictionary in use may belong to another drive or firmware");
  if (is_signed(type)) return Value(sign_extended(load_le(bytes), bits_of(type)));
  if (is_unsigned(type)) return Value(load_le(bytes));
  if (type == DataType::f32)
    return Value(shortest(std::bit_cast<float>(static_cast<std::uint32_t>(load_le(bytes)))));
  if (type == DataType::f64) return Value(std::bit_cast<double>(load_le(bytes)));
  if (type != DataType::string) return Value(Bytes(bytes.begin(), bytes.end()));
  std::string text(bytes.begin(), bytes.end());
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return Value(std::move(text));
}

Result<Value> parse_value(DataType type, std::string_view text) {
  if (is_integer(type)) return parse_integer_value(type, trim(text));
  if (is_real(type)) {
    const auto number = parse_real(trim(text));
    if (!number) return not_a_value(type, text);
    return Value(*number);
  }
  if (type == DataType::string && !starts_with_nocase(text, "hex:")) return Value(std::string(text));
  auto bytes = parse_bytes_value(type, text);
  if (bytes && type == DataType::string) {
    const auto& raw = std::get<Bytes>(*bytes);
    return Value(std::string(raw.begin(), raw.end()));
  }
  return bytes;
}

std::string to_string(const Value& value) {
  struct Text {
    std::string operator()(std::int64_t i) const { return formatted("{}", i); }
    std::string operator()(std::uint64_t u) const { return formatted("{}", u); }
    std::string operator()(double d) const { return formatted("{}", d); }
    std::string operator()(const std::string& s) const { return s; }
    std::string operator()(const Bytes& b) const { return to_hex(b); }
  };
  return std::visit(Text{}, value);
}

double to_double(const Value& value) {
  if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
  if (const auto* u = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*u);
  if (const auto* d = std::get_if<double>(&value)) return *d;
  return 0;
}

int compare_numbers(const Value& a, const Value& b) {
  const auto is_text = [](const Value& v) {
    return std::holds_alternative<std::string>(v) || std::holds_alternative<Bytes>(v);
  };
  if (is_text(a) || is_text(b)) return 0;
  const auto order = [](auto x, auto y) { return x < y ? -1 : y < x ? 1 : 0; };
  if (std::holds_alternative<double>(a) || std::holds_alternative<double>(b))
    return order(to_double(a), to_double(b));
  const auto* sa = std::get_if<std::int64_t>(&a);
  const auto* sb = std::get_if<std::int64_t>(&b);
  const bool negative_a = sa != nullptr && *sa < 0;
  const bool negative_b = sb != nullptr && *sb < 0;
  if (negative_a != negative_b) return negative_a ? -1 : 1;
  const auto magnitude = [](const Value& v, const std::int64_t* s) {
    return s != nullptr ? static_cast<std::uint64_t>(*s) : std::get<std::uint64_t>(v);
  };
  return order(magnitude(a, sa),
               magnitude(b, sb));  // Two negative ones keep their order as unsigned numbers.
}

}  // namespace servoctl::od
