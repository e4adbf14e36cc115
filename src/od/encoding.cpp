#include "od/encoding.hpp"

#include <bit>
#include <cmath>

#include "base/format.hpp"

namespace servoctl::od {

std::string_view name(Encoding encoding) {
  switch (encoding) {
    case Encoding::plain: return "";
    case Encoding::f32: return "f32";
    case Encoding::f32hi: return "f32hi";
  }
  return "";
}

std::optional<Encoding> parse_encoding(std::string_view text) {
  for (const auto encoding : {Encoding::plain, Encoding::f32, Encoding::f32hi})
    if (name(encoding) == text) return encoding;
  return std::nullopt;
}

double decode_number(Encoding encoding, const Value& raw) {
  if (encoding == Encoding::plain) return to_double(raw);
  const auto* with_sign = std::get_if<std::int64_t>(&raw);
  const auto* without = std::get_if<std::uint64_t>(&raw);
  const auto bits = static_cast<std::uint32_t>(with_sign != nullptr ? static_cast<std::uint64_t>(*with_sign)
                                               : without != nullptr ? *without
                                                                    : 0);
  return static_cast<double>(std::bit_cast<float>(encoding == Encoding::f32hi ? bits << 16U : bits));
}

Result<Value> encode_number(Encoding encoding, DataType type, double number) {
  const auto real = static_cast<float>(number);
  if (!std::isfinite(number) || !std::isfinite(real))
    return fail(Errc::usage, message("{:g} is too large for a number of 32 bits", number));
  const auto bits = std::bit_cast<std::uint32_t>(real);
  const auto raw = encoding == Encoding::f32hi ? bits >> 16U : bits;
  if (!is_signed(type)) return Value(std::uint64_t{raw});
  return Value(encoding == Encoding::f32hi ? std::int64_t{static_cast<std::int16_t>(raw)}
                                           : std::int64_t{static_cast<std::int32_t>(raw)});
}

}  // namespace servoctl::od
