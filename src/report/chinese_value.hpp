#pragma once

#include <string_view>

#include "report/catalogue.hpp"
#include "report/value.hpp"

namespace servoctl::report {

/// The value as Chinese readers see it: headings, texts in fields and cells, lines below tables, names of
/// plotted quantities, yes and no. For text and pages only: in JSON it says something else. What users or
/// drives say of themselves (names of devices and files) stays as it is.
Value chinese_value(Value value, const Names* names = nullptr);

/// Whether the field or column of this key holds such words.
bool is_own_word(std::string_view key);

}  // namespace servoctl::report
