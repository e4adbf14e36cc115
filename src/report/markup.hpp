#pragma once

#include <string>
#include <string_view>

namespace servoctl::report {

/// Text that stands for itself between tags and inside quoted attributes of HTML and XML, whatever it holds:
/// markup is escaped, what is not printable() is written out.
std::string escaped(std::string_view text);

}  // namespace servoctl::report
