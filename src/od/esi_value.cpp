#include "od/esi_value.hpp"

#include <array>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

constexpr std::string_view kEnglish = "1033";

/// Primary language of a Windows locale: its low ten bits.
std::uint64_t language_of(std::uint64_t locale) { return locale & 0x3FFU; }
constexpr std::uint64_t kEnglishLanguage = 0x09;
constexpr std::uint64_t kChineseLanguage = 0x04;

/// `#x1F` as the rest of the house reads numbers: `0x1F`.
std::string with_0x(std::string_view text) {
  const bool hexadecimal = text.size() > 2 && text[0] == '#' && (text[1] == 'x' || text[1] == 'X');
  return hexadecimal ? "0x" + std::string(text.substr(2)) : std::string(text);
}

std::uint64_t checked_number(XmlElement element, std::string_view what, std::string_view text,
                             std::uint64_t max, EsiFindings& findings, std::uint64_t otherwise) {
  if (text.empty()) return otherwise;
  const auto number = esi_integer(text);
  if (number && !number->negative && number->magnitude <= max) return number->magnitude;
  findings.error(element, "bad-number",
                 formatted("{}: '{}' is not a number from 0 to {}", what, shown(text), max),
                 "write a number such as 26 or #x1A");
  return otherwise;
}

/// The bytes of a DefaultData for this type: shorter ones are filled with zeros, longer ones cut where only
/// zeros go.
std::optional<Bytes> fitted_data(XmlElement element, DataType type, Bytes bytes, EsiFindings& findings) {
  const auto size = size_of(type);
  if (!size || bytes.size() == *size) return bytes;
  bool loses = false;
  for (std::size_t i = *size; i < bytes.size(); ++i) loses = loses || bytes[i] != 0;
  const auto message = formatted("{}: {} bytes, {} has {}", element.name(), bytes.size(), name(type), *size);
  if (loses) {
    findings.error(element, "data-length", message, formatted("write {} bytes", *size));
    return std::nullopt;
  }
  if (type != DataType::boolean)
    findings.warn(element, "data-length", message, formatted("write {} bytes", *size));
  bytes.resize(*size);
  return bytes;
}

class EsiValueReader {
 public:
  EsiValueReader(DataType type, EsiFindings& findings) : type_(type), findings_(&findings) {}

  /// Of the first of the elements that is there and not empty.
  std::optional<NodeValue> read(XmlElement info, std::span<const char* const> names, bool limit) {
    for (const auto* name : names) {
      const auto element = info.child(name);
      if (!element || element.text().empty()) continue;
      auto value =
          std::string_view(name).ends_with("Data") ? from_data(element, limit) : from_text(element, limit);
      if (!value) return std::nullopt;
      return NodeValue{std::move(*value), false};
    }
    return std::nullopt;
  }

 private:
  std::optional<Value> from_data(XmlElement element, bool limit) {
    const auto text = element.text();
    if (text.starts_with('#')) return from_text(element, limit);
    auto bytes = parse_hex_bytes(text);
    if (!bytes) {
      tell(element, limit, formatted("'{}' is not bytes in hexadecimal", shown(text)),
           "write two digits a byte, the low byte first: 2C01 for 300");
      return std::nullopt;
    }
    auto fitting = fitted_data(element, type_, std::move(*bytes), *findings_);
    if (!fitting) return std::nullopt;
    auto value = decode(type_, *fitting);
    return value ? std::optional(std::move(*value)) : std::nullopt;
  }

  std::optional<Value> from_text(XmlElement element, bool limit) {
    const auto text = element.text();
    if (type_ == DataType::string) return Value(std::string(text));
    const auto written = with_0x(text);
    auto value = parse_value(type_, type_ == DataType::bytes ? text : std::string_view(written));
    if (value && encode(type_, *value)) return std::move(*value);
    const auto why = value ? formatted("'{}' does not fit {}", shown(text), name(type_))
                           : clip(value.error().message.text(), 200);
    tell(element, limit, why, formatted("write a value of {}, or leave it out", name(type_)));
    return std::nullopt;
  }

  void tell(XmlElement element, bool limit, std::string_view why, std::string remedy) {
    if (limit)
      findings_->warn(element, "limit-outside-type",
                      formatted("{}: {}; no limit is taken", element.name(), why), std::move(remedy));
    else
      findings_->error(element, "bad-value", formatted("{}: {}", element.name(), why), std::move(remedy));
  }

  DataType type_;
  EsiFindings* findings_;
};

}  // namespace

std::optional<Integer> esi_integer(std::string_view text) { return parse_integer(with_0x(text)); }

std::uint64_t esi_number(XmlElement element, std::uint64_t max, EsiFindings& findings,
                         std::uint64_t otherwise) {
  return checked_number(element, element.name(), element.text(), max, findings, otherwise);
}

std::optional<std::int64_t> esi_signed(std::string_view text) {
  const auto number = esi_integer(text);
  return number ? number->as_signed() : std::nullopt;
}

std::uint64_t esi_attribute(XmlElement element, const char* name, std::uint64_t max, EsiFindings& findings,
                            std::uint64_t otherwise) {
  return checked_number(element, name, element.attribute(name), max, findings, otherwise);
}

bool esi_flag(std::string_view text) { return text == "1" || equals_nocase(text, "true"); }

EsiText esi_text(XmlElement parent, const char* name) {
  EsiText out;
  std::string other;
  for (const auto& element : parent.children(name)) {
    const auto text = element.text();
    if (text.empty()) continue;
    const auto locale = element.attribute("LcId");
    const auto number = locale.empty() ? std::nullopt : esi_integer(locale);
    const auto language = number ? language_of(number->magnitude) : 0;
    const bool english = locale.empty() || language == kEnglishLanguage;
    auto& place = english ? out.english : language == kChineseLanguage ? out.chinese : other;
    if (place.empty() || locale == kEnglish) place = std::string(text);
  }
  if (out.english.empty()) out.english = other.empty() ? out.chinese : other;
  return out;
}

void esi_values(XmlElement info, Entry& entry, EsiFindings& findings) {
  if (!info || entry.type == DataType::domain) return;
  constexpr std::array kDefault{"DefaultString", "DefaultData", "DefaultValue"};
  constexpr std::array kLow{"MinData", "MinValue"};
  constexpr std::array kHigh{"MaxData", "MaxValue"};
  EsiValueReader reader(entry.type, findings);
  if (auto value = reader.read(info, kDefault, false)) entry.default_value = std::move(value);
  if (!is_integer(entry.type) && !is_real(entry.type)) return;
  if (auto value = reader.read(info, kLow, true)) entry.low = std::move(value);
  if (auto value = reader.read(info, kHigh, true)) entry.high = std::move(value);
}

void check_esi_limits(XmlElement info, Entry& entry, EsiFindings& findings) {
  const auto above = [](const std::optional<NodeValue>& a, const std::optional<NodeValue>& b) {
    return a && b && compare_numbers(a->value, b->value) > 0;
  };
  const auto address = to_string(entry.address);
  if (above(entry.low, entry.high)) {
    findings.warn(
        info, "limits-crossed",
        formatted("{}: the lowest value {} is above the highest, {}, in {}; neither is used", address,
                  to_string(entry.low->value), to_string(entry.high->value), name(entry.type)),
        "correct the limits or the type");
    entry.low = entry.high = std::nullopt;
  }
  const bool below = above(entry.low, entry.default_value);
  if (below || above(entry.default_value, entry.high))
    findings.warn(info, "default-out-of-limits",
                  formatted("{}: the default {} is {} {}", address, to_string(entry.default_value->value),
                            below ? "below the lowest value," : "above the highest value,",
                            to_string((below ? entry.low : entry.high)->value)),
                  "correct the limits or the default");
}

}  // namespace servoctl::od
