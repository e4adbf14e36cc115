#pragma once

#include <string>
#include <string_view>

namespace servoctl {

/// The text in double quotes as TOML and JSON read it; controls are written out: `\u000A`.
std::string toml_text(std::string_view text);

}  // namespace servoctl
