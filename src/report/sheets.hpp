#pragma once

#include <string>

#include "report/html.hpp"

/// What of a page is for paper and pen.
namespace servoctl::report {

/// Style rules: size and margins of the sheets, their head and foot, as the sections of the page want them.
std::string sheet_rules(const Page& page);

/// The lines to be signed, as a table with room for a pen; nothing where nobody signs.
std::string signature_lines(const Page& page);

}  // namespace servoctl::report
