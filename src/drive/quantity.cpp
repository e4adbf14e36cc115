#include "drive/quantity.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/pdo_index.hpp"
#include "base/text.hpp"
#include "drive/standard_objects.hpp"
#include "drive/unit.hpp"
#include "drive/word_bits.hpp"
#include "od/real_number.hpp"

namespace servoctl::drive {
namespace {

/// A step is met when the value lies within a thousandth of it: numbers with many digits are rounded on
/// paper.
constexpr double kWhole = 1e-3;

/// The double nearest to the decimal number with so many significant digits: takes the noise of 400 × 0.1
/// away.
double tidy(double value, int digits = 12) {
  return parse_real(formatted("{:.{}g}", value, digits)).value_or(value);
}

/// How many of the object's own unit the given unit is; by the drive's own measure where there is one.
std::optional<double> in_own_unit(const Meaning& meaning, std::string_view unit) {
  if (const auto direct = conversion(unit, meaning.unit)) return direct;
  if (!meaning.bridge) return std::nullopt;
  const auto bridged = conversion(unit, meaning.bridge->unit);
  return bridged ? std::optional(*bridged / meaning.bridge->factor) : std::nullopt;
}

tl::unexpected<Error> inconvertible(const Meaning& meaning, const NumberWithUnit& given,
                                    std::string_view text) {
  if (meaning.unit.empty())
    return fail(Errc::usage, message("'{}' carries a unit, but this object has none", as_it_is(text)),
                "write the plain number");
  auto hint = message("write a value in {} or the raw number", meaning.unit);
  if (meaning.measure && !meaning.bridge) hint += "; its scale could not be read from the drive";
  return fail(Errc::usage,
              message("'{}': the unit of this object is {}; {} cannot be converted to it", as_it_is(text),
                      meaning.unit, given.unit),
              std::move(hint));
}

enum class Steps : std::uint8_t { exact, nearest };

/// The range as it is sent, and where a step is not one of the unit, in the unit: `1..65535 = 0.1..6553.5
/// Hz`.
std::string whole_range(const Meaning& meaning) {
  auto out = range_text(meaning);
  const bool in_steps =
      meaning.scale != 1 && meaning.encoding == od::Encoding::plain && !meaning.unit.empty();
  if (!in_steps || !meaning.min || !meaning.max || meaning.least) return out;
  const auto in_unit = [&](const od::Value& limit) { return plain_number(scaled(meaning, limit), 12); };
  return out + formatted(" = {}..{} {}", in_unit(*meaning.min), in_unit(*meaning.max), meaning.unit);
}

tl::unexpected<Error> out_of_range(const Meaning& meaning, std::string_view said, Message hint = {}) {
  return fail(Errc::usage, message("{} is out of range: {}", said, whole_range(meaning)), std::move(hint));
}

tl::unexpected<Error> too_large(std::string_view text) {
  return fail(Errc::usage, message("'{}' is too large for this object", as_it_is(text)));
}

/// A number that an object carries encoded; it has fewer digits than the number.
Result<Quantity> encoded(const Meaning& meaning, double number) {
  const auto value = od::encode_number(meaning.encoding, meaning.type, number);
  if (!value) return fail(value.error());
  const double held = od::decode_number(meaning.encoding, *value);
  const auto rounding =
      judge_rounding({number * meaning.scale, held * meaning.scale, 0, std::string(meaning.unit)});
  if (!rounding) return fail(rounding.error());
  return Quantity{*value, *rounding};
}

/// A limit of whole steps; where there is none the number itself.
double bound(const std::optional<od::Value>& limit, double number) {
  return limit ? od::decode_number(od::Encoding::plain, *limit) : number;
}

/// Beyond a limit, and not only beyond what the type holds.
bool is_beyond(const Meaning& meaning, double number) {
  return number < bound(meaning.min, number) || number > bound(meaning.max, number);
}

Result<Quantity> from_physical(const Meaning& meaning, const NumberWithUnit& given, std::string_view text,
                               Steps steps) {
  const auto factor = in_own_unit(meaning, given.unit);
  if (!factor) return inconvertible(meaning, given, text);
  const double raw = tidy(given.number * *factor / meaning.scale);
  if (!std::isfinite(raw)) return too_large(text);
  if (meaning.encoding != od::Encoding::plain) return encoded(meaning, raw);
  if (od::is_real(meaning.type)) return Quantity{od::Value(raw), {}};
  if (std::abs(raw) > 9.0e18) return too_large(text);
  const double whole = static_cast<double>(std::llrint(raw));
  const double step = meaning.scale / *factor;
  const double nearest = std::clamp(whole, bound(meaning.min, whole), bound(meaning.max, whole));
  if (steps == Steps::exact && std::abs(raw - whole) > kWhole)
    return fail(Errc::usage,
                message("'{}' is {} steps of {} {}, not a whole number", as_it_is(text), plain_number(raw, 9),
                        plain_number(meaning.scale, 6), meaning.unit),
                message("the nearest value is {} {}", plain_number(tidy(nearest * step), 9), given.unit));
  const auto rounding =
      judge_rounding({given.number, tidy(whole * step), std::abs(step), std::string(given.unit)});
  if (!rounding) return fail(rounding.error());
  const auto value = od::parse_value(meaning.type, formatted("{:.0f}", whole));
  if (!value && is_beyond(meaning, whole)) return out_of_range(meaning, text);
  if (!value) return fail(value.error());
  return Quantity{*value, *rounding};
}

/// Bit patterns of numbers do not stand in the order of the numbers.
int compare(const Meaning& meaning, const od::Value& a, const od::Value& b) {
  if (meaning.encoding == od::Encoding::plain) return od::compare_numbers(a, b);
  const double x = od::decode_number(meaning.encoding, a);
  const double y = od::decode_number(meaning.encoding, b);
  return x < y ? -1 : x > y ? 1 : 0;
}

/// `10H` is ten henry where the object's unit is H, and 16 everywhere else.
bool ends_in_own_unit(const Meaning& meaning, std::string_view text) {
  return equals_nocase(meaning.unit, "h") && !text.empty() && (text.back() == 'h' || text.back() == 'H') &&
         split_unit(text).has_value();
}

/// COB-IDs (CiA 301, 7.5.2), and what a PDO carries: an index, a sub-index and a number of bits.
bool is_of_fields(ObjectAddress object) {
  const bool alone = object.index == 0x1005 || object.index == 0x1012 || object.index == 0x1014;
  if (alone) return object.sub == 0;
  if (object.index >= 0x1200 && object.index <= 0x12FF) return object.sub == 1 || object.sub == 2;
  if (is_pdo_communication(object.index)) return object.sub == 1;
  return is_pdo_mapping(object.index) && object.sub != 0;
}

/// Of any axis. 60FEh has levels, and which of them are set at all.
bool is_of_bits(ObjectAddress object) {
  const auto first = of_first_axis(object);
  constexpr std::array kBitObjects{objects::kErrorRegister, objects::kControlword, objects::kStatusword,
                                   objects::kDigitalInputs, objects::kSupportedModes};
  return is_of_fields(object) ||
         std::find(kBitObjects.begin(), kBitObjects.end(), first) != kBitObjects.end() ||
         (first.index == objects::kDigitalOutputsIndex && first.sub != 0);
}

}  // namespace

std::size_t hex_digits(const Meaning& meaning, std::uint64_t word) {
  const std::size_t bytes = word > 0xFFFFU ? 4 : 2;
  return 2 * (meaning.type_known ? od::size_of(meaning.type).value_or(bytes) : bytes);
}

std::string plain_text(const Meaning& meaning, const od::Value& value) {
  if (const auto* word = std::get_if<std::uint64_t>(&value); word != nullptr && meaning.bits)
    return formatted("0x{:0{}X}", *word, hex_digits(meaning, *word));
  return meaning.encoding == od::Encoding::plain ? od::to_string(value)
                                                 : plain_number(scaled(meaning, value), 12);
}

Meaning meaning(const Target& target, std::uint8_t node) {
  Meaning out;
  out.bits = is_of_bits(target.address);
  if (target.parameter != nullptr) {
    const auto& parameter = *target.parameter;
    out.type = parameter.type;
    out.type_known = true;
    out.access = parameter.access;
    out.unit = parameter.unit;
    out.scale = parameter.scale;
    out.min = parameter.min;
    out.max = parameter.max;
    out.labels = parameter.labels.empty() ? nullptr : &parameter.labels;
    out.effect = parameter.effect;
    out.encoding = parameter.encoding;
    out.size_known = !parameter.doubts.about("type");
    out.measure = needed_measure(out.unit, target.address);
    return out;
  }
  if (target.read_only) out.access = od::Access::ro;
  if (target.entry == nullptr) return out;
  const auto& entry = *target.entry;
  out.type = entry.type;
  out.type_known = true;
  out.access = entry.access;
  out.unit = entry.unit;
  out.scale = entry.scale;
  if (entry.low) out.min = entry.low->for_node(node);
  if (entry.high) out.max = entry.high->for_node(node);
  out.least = entry.least;
  out.least_assumed = std::any_of(entry.doubts.assumed.begin(), entry.doubts.assumed.end(),
                                  [](const od::Mark& mark) { return mark.field == "least"; });
  out.labels = entry.labels.empty() ? nullptr : &entry.labels;
  out.effect = entry.effect;
  out.encoding = entry.encoding;
  out.size_known = !entry.doubts.about("type");
  out.measure = needed_measure(out.unit, target.address);
  return out;
}

Meaning fitted(Meaning meaning, std::size_t bytes) {
  if (!meaning.type_known || meaning.size_known || !od::is_integer(meaning.type)) return meaning;
  const auto fitting = [&](od::DataType type) {
    return od::is_signed(type) == od::is_signed(meaning.type) && od::size_of(type) == bytes;
  };
  for (const auto type : {od::DataType::i8, od::DataType::i16, od::DataType::i32, od::DataType::i64,
                          od::DataType::u8, od::DataType::u16, od::DataType::u32, od::DataType::u64})
    if (fitting(type)) meaning.type = type;
  if (meaning.encoding != od::Encoding::plain)
    meaning.encoding = bytes == 2 ? od::Encoding::f32hi : od::Encoding::f32;
  return meaning;
}

Meaning as_answered(Meaning meaning, std::size_t bytes) {
  // The bits of a float have the length of a float.
  if (meaning.encoding == od::Encoding::plain) meaning.size_known = false;
  return fitted(std::move(meaning), bytes);
}

Result<void> check_limits(const Meaning& meaning, const od::Value& value) {
  if (!od::is_number(meaning.encoding, value))
    return fail(Errc::usage, "its bits are those of infinity or of no number (NaN)", "give a finite number");
  const bool low = meaning.min && compare(meaning, value, *meaning.min) < 0;
  const bool high = meaning.max && compare(meaning, value, *meaning.max) > 0;
  if (!low && !high && !is_too_little(meaning, value)) return {};
  Message hint;
  if (meaning.labels != nullptr)
    hint = "values: " + labels_text(*meaning.labels);
  else if (meaning.scale != 1)
    hint = message("one step is {} {}", plain_number(meaning.scale, 6), meaning.unit);
  else if (is_too_little(meaning, value))
    hint = message(
        "0 switches it off{}",
        meaning.least_assumed
            ? message("; the minimum {} is assumed: the manual may mean the step size", *meaning.least)
            : Message());
  return out_of_range(meaning, plain_text(meaning, value), std::move(hint));
}

namespace {

Result<Quantity> read(const Meaning& meaning, std::string_view text, Steps steps) {
  if (const auto* label = find_label(meaning, text)) {
    const auto value = od::parse_value(meaning.type, formatted("{}", label->value));
    if (!value) return fail(value.error());
    return Quantity{*value, {}};
  }
  if (meaning.encoding != od::Encoding::plain)
    if (const auto real = parse_real(text)) return encoded(meaning, *real / meaning.scale);
  const bool number = od::is_integer(meaning.type) || od::is_real(meaning.type);
  if (number && (!parse_integer(text) || ends_in_own_unit(meaning, text)))
    if (const auto physical = split_unit(text)) return from_physical(meaning, *physical, text, steps);
  const auto plain = od::parse_value(meaning.type, text);
  if (!plain && meaning.labels != nullptr && !parse_integer(text))
    return fail(Errc::usage, message("'{}' is not a value of this object", as_it_is(text)),
                "values: " + labels_text(*meaning.labels));
  const auto integer = parse_signed(text);
  if (!plain && integer && is_beyond(meaning, static_cast<double>(*integer)))
    return out_of_range(meaning, text);
  if (!plain) return fail(plain.error());
  return Quantity{*plain, {}};
}

Result<Quantity> read_checked(const Meaning& meaning, std::string_view text, Steps steps) {
  auto quantity = read(meaning, trim(text), steps);
  if (!quantity) return quantity;
  if (const auto checked = check_limits(meaning, quantity->value); !checked) return fail(checked.error());
  return quantity;
}

}  // namespace

Result<od::Value> parse_quantity(const Meaning& meaning, std::string_view text) {
  const auto quantity = read_checked(meaning, text, Steps::exact);
  if (!quantity) return fail(quantity.error());
  return quantity->value;
}

Result<Quantity> nearest_quantity(const Meaning& meaning, std::string_view text) {
  return read_checked(meaning, text, Steps::nearest);
}

bool needs_bridge(const Meaning& meaning, std::string_view text) {
  if (!meaning.measure || parse_integer(trim(text))) return false;
  const auto given = split_unit(trim(text));
  return given && !conversion(given->unit, meaning.unit);
}

double scaled(const Meaning& meaning, const od::Value& value) {
  if (meaning.encoding == od::Encoding::plain) {
    const double raw = od::to_double(value);
    return meaning.scale == 1 ? raw : tidy(raw * meaning.scale);
  }
  const double number = od::decode_number(meaning.encoding, value) * meaning.scale;
  return parse_real(formatted("{}", static_cast<float>(number))).value_or(number);
}

std::optional<Familiar> familiar(const Meaning& meaning, const od::Value& value) {
  if (std::holds_alternative<std::string>(value) || std::holds_alternative<Bytes>(value)) return std::nullopt;
  const double own = scaled(meaning, value);
  if (meaning.bridge) return Familiar{tidy(own * meaning.bridge->factor, 14), meaning.bridge->unit};
  const auto unit = familiar_unit(meaning.unit);
  if (unit.empty()) return std::nullopt;
  return Familiar{tidy(own * conversion(meaning.unit, unit).value_or(1)), unit};
}

bool is_too_little(const Meaning& meaning, const od::Value& value) {
  return meaning.least && od::compare_numbers(value, od::Value(std::uint64_t{0})) != 0 &&
         od::compare_numbers(value, od::Value(*meaning.least)) < 0;
}

std::string range_text(const Meaning& meaning) {
  if (meaning.least && meaning.max)
    return formatted("0, or {}..{}", *meaning.least, plain_text(meaning, *meaning.max));
  if (meaning.least) return formatted("0, or at least {}", *meaning.least);
  if (meaning.min && meaning.max)
    return formatted("{}..{}", plain_text(meaning, *meaning.min), plain_text(meaning, *meaning.max));
  if (meaning.min) return "at least " + plain_text(meaning, *meaning.min);
  if (meaning.max) return "at most " + plain_text(meaning, *meaning.max);
  return {};
}

}  // namespace servoctl::drive
