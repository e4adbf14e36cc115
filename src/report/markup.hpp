#pragma once

#include <string>
#include <string_view>

namespace servoctl::report {

/// Text that stands for itself between tags and inside quoted attributes of HTML and XML, whatever it holds:
/// markup is escaped, control characters are written out, what is no UTF-8 becomes U+FFFD.
std::string escaped(std::string_view text);

}  // namespace servoctl::report
