#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "od/eds.hpp"
#include "od/ini.hpp"

namespace servoctl::od {

/// Collects what is wrong in a file.
class Findings {
 public:
  void error(const IniKey& key, std::string rule, std::string message, std::string remedy);
  void warn(const IniKey& key, std::string rule, std::string message, std::string remedy);
  void add(Severity severity, std::uint32_t line, std::uint32_t column, std::string rule, std::string message,
           std::string remedy);
  /// In rising line.
  std::vector<Diagnostic> take();

 private:
  std::vector<Diagnostic> all_;
};

/// A number as EDS files write them: `0x1F`, `31`; a leading zero is decimal, as vendors mean it, and told as
/// a warning (CiA 306-1 would read octal). Empty when it is none or above `max`; that is told as an error.
std::optional<std::uint64_t> eds_number(const IniKey& key, std::uint64_t max, Findings& findings);

/// A value of `type`, maybe with `$NODEID` in any case and on either side of the plus. Empty when the key is
/// missing, its value empty, or wrong; the last is told as an error.
std::optional<NodeValue> eds_value(const IniKey* key, DataType type, Findings& findings);

/// The entry a section describes: name, type, access, mapping, limits, default. Empty when it cannot be used;
/// told why.
std::optional<Entry> eds_entry(const IniSection& section, ObjectAddress address, Findings& findings);

}  // namespace servoctl::od
