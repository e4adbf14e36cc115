#include "od/eds_entry.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <utility>

#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::od {
namespace {

constexpr std::string_view kNodeId = "$nodeid";

struct AccessRow {
  std::string_view word;
  Access access;
  PdoMapping direction;  ///< When the entry may be mapped.
};

/// CiA 306-1, 4.6.2.4: rwr is mapped when read (TPDO), rww when written (RPDO).
constexpr std::array kAccess{
    AccessRow{"ro", Access::ro, PdoMapping::tpdo},  AccessRow{"rw", Access::rw, PdoMapping::both},
    AccessRow{"wo", Access::wo, PdoMapping::rpdo},  AccessRow{"const", Access::constant, PdoMapping::tpdo},
    AccessRow{"rwr", Access::rw, PdoMapping::tpdo}, AccessRow{"rww", Access::rw, PdoMapping::rpdo},
};

bool has_leading_zero(std::string_view text) {
  return text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9';
}

void warn_of_leading_zero(const IniKey& key, std::string_view number, Findings& findings) {
  if (has_leading_zero(number))
    findings.warn(key, "leading-zero",
                  fmt::format("'{}' is taken as decimal; by the standard a leading zero means octal", number),
                  "write it without leading zeros, or with 0x");
}

/// Cuts `$NODEID` and its plus off; what remains is the number, `0` when nothing does.
std::pair<std::string_view, bool> without_node_id(std::string_view text) {
  const auto at = lower(text).find(kNodeId);
  if (at == std::string::npos) return {text, false};
  auto rest = trim(at == 0 ? text.substr(kNodeId.size()) : text.substr(0, at));
  if (!rest.empty() && rest.front() == '+') rest = trim(rest.substr(1));
  if (!rest.empty() && rest.back() == '+') rest = trim(rest.substr(0, rest.size() - 1));
  return {rest.empty() ? std::string_view("0") : rest, true};
}

std::optional<DataType> entry_type(const IniSection& section, Findings& findings) {
  const auto* key = section.find("DataType");
  if (key == nullptr || key->value.empty()) {
    findings.add(Severity::error, section.line, 1, "missing-data-type",
                 fmt::format("[{}] has no DataType", section.name),
                 "add DataType, for example DataType=0x0007 for an unsigned number of 32 bits");
    return std::nullopt;
  }
  const auto code = eds_number(*key, 0xFFFF, findings);
  if (!code) return std::nullopt;
  const auto type = data_type_from_cia(*code);
  if (!type)
    findings.error(*key, "unknown-data-type", fmt::format("0x{:04X} is no data type of CiA 301", *code),
                   "use one of 0x0001 to 0x001B (CiA 301, table 44)");
  return type;
}

void read_access(const IniSection& section, Entry& entry, Findings& findings) {
  const auto* key = section.find("AccessType");
  const AccessRow* row = nullptr;
  if (key != nullptr)
    for (const auto& candidate : kAccess)
      if (equals_nocase(candidate.word, key->value)) row = &candidate;
  if (key == nullptr) {
    findings.add(Severity::error, section.line, 1, "missing-access-type",
                 fmt::format("[{}] has no AccessType; taken as ro", section.name),
                 "add AccessType=ro, rw, wo or const");
  } else if (row == nullptr) {
    findings.error(*key, "unknown-access-type",
                   fmt::format("'{}' is no access type; taken as ro", key->value),
                   "write ro, rw, wo, const, rwr or rww");
  }
  // What is not known to be writable is not written.
  if (row == nullptr) row = &kAccess[0];
  entry.access = row->access;
  const auto* mapping = section.find("PDOMapping");
  if (mapping == nullptr || mapping->value.empty()) return;
  const auto mappable = eds_number(*mapping, 1, findings);
  if (mappable.value_or(0) == 1) entry.pdo = row->direction;
}

void check_order(const IniSection& section, const Entry& entry, Findings& findings) {
  const auto tell = [&](std::string_view rule, const std::string& message) {
    findings.add(Severity::warning, section.line, 1, std::string(rule),
                 fmt::format("[{}]: {}", section.name, message),
                 "correct LowLimit, HighLimit or DefaultValue");
  };
  const auto above = [](const std::optional<NodeValue>& a, const std::optional<NodeValue>& b) {
    return a && b && compare_numbers(a->for_node(1), b->for_node(1)) > 0;
  };
  if (above(entry.low, entry.high)) tell("limits-crossed", "LowLimit is above HighLimit");
  if (above(entry.low, entry.default_value) || above(entry.default_value, entry.high))
    tell("default-out-of-limits", "DefaultValue is not within the limits");
}

}  // namespace

void Findings::add(Severity severity, std::uint32_t line, std::uint32_t column, std::string rule,
                   std::string message, std::string remedy) {
  all_.push_back({severity, line, column, std::move(rule), std::move(message), std::move(remedy)});
}

void Findings::error(const IniKey& key, std::string rule, std::string message, std::string remedy) {
  add(Severity::error, key.line, key.value_column, std::move(rule), std::move(message), std::move(remedy));
}

void Findings::warn(const IniKey& key, std::string rule, std::string message, std::string remedy) {
  add(Severity::warning, key.line, key.value_column, std::move(rule), std::move(message), std::move(remedy));
}

std::vector<Diagnostic> Findings::take() {
  std::stable_sort(all_.begin(), all_.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.line < b.line; });
  return std::move(all_);
}

std::optional<std::uint64_t> eds_number(const IniKey& key, std::uint64_t max, Findings& findings) {
  const auto number = parse_integer(key.value);
  if (!number || number->negative || number->magnitude > max) {
    findings.error(key, "bad-number",
                   fmt::format("{}: '{}' is no number of 0 to {}", key.key, key.value, max),
                   "write a number such as 7 or 0x7");
    return std::nullopt;
  }
  warn_of_leading_zero(key, key.value, findings);
  return number->magnitude;
}

std::optional<NodeValue> eds_value(const IniKey* key, DataType type, Findings& findings) {
  if (key == nullptr || key->value.empty()) return std::nullopt;
  const auto [text, plus_node_id] = without_node_id(key->value);
  if (plus_node_id && !is_integer(type)) {
    findings.error(*key, "bad-value", fmt::format("{}: $NODEID in a value of {}", key->key, name(type)),
                   "only integers can contain the node-ID");
    return std::nullopt;
  }
  auto value = parse_value(type, text);
  if (!value) {
    findings.error(*key, "bad-value", fmt::format("{}: {}", key->key, value.error().message),
                   fmt::format("write a value of {}, or leave it empty", name(type)));
    return std::nullopt;
  }
  if (is_integer(type)) warn_of_leading_zero(*key, text, findings);
  return NodeValue{std::move(*value), plus_node_id};
}

std::optional<Entry> eds_entry(const IniSection& section, ObjectAddress address, Findings& findings) {
  const auto type = entry_type(section, findings);
  if (!type) return std::nullopt;
  Entry entry;
  entry.address = address;
  entry.type = *type;
  entry.line = section.line;
  const auto* name = section.find("ParameterName");
  if (name == nullptr || name->value.empty())
    findings.add(Severity::warning, section.line, 1, "missing-name",
                 fmt::format("[{}] has no ParameterName", section.name), "add ParameterName");
  else
    entry.name = std::string(name->value);
  read_access(section, entry, findings);
  entry.default_value = eds_value(section.find("DefaultValue"), *type, findings);
  entry.low = eds_value(section.find("LowLimit"), *type, findings);
  entry.high = eds_value(section.find("HighLimit"), *type, findings);
  entry.configured = eds_value(section.find("ParameterValue"), *type, findings);
  check_order(section, entry, findings);
  return entry;
}

}  // namespace servoctl::od
