#pragma once

#include <optional>

#include "od/dictionary.hpp"
#include "od/eds_findings.hpp"
#include "od/eds_types.hpp"
#include "od/ini.hpp"

namespace servoctl::od {

/// The object code of a section; VAR where it says none (CiA 306-1, 4.6.3.1). A name such as `ARRAY` is taken
/// with a warning.
ObjectCode eds_object_code(const IniSection& section, Findings& findings);

/// The entry a section describes: name, type, access, mapping, limits, default. Empty when it cannot be used;
/// told why.
std::optional<Entry> eds_entry(const IniSection& section, ObjectAddress address, const LimitTypes& types,
                               Findings& findings);

}  // namespace servoctl::od
