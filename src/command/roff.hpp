#pragma once

#include <string>
#include <string_view>

/// Text in the language of manual pages, man(7), as groff and mandoc read it: ASCII only, and nothing in it
/// is taken for a request.
namespace servoctl::command {

/// What is typed as it stands: every hyphen is a minus, every quote the one of ASCII.
std::string roff_literal(std::string_view text);

/// Lines of running text: what stands between backticks is bold, each sentence begins a line, and words are
/// not torn apart. Ends with a line break unless it is empty.
std::string roff_text(std::string_view text);

}  // namespace servoctl::command
