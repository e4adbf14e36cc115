#pragma once

#include <string>
#include <string_view>

#include "cli/outcome.hpp"
#include "cli/parse.hpp"

namespace servoctl::cli {

/// The text with the place of the line in the commands that it names in backquotes: what the line itself said
/// of bus, node, family and cabinet file, as far as the command needs it and does not say it. So it can be
/// typed after that line as it is printed; what the prompt or the environment says holds for it anyway.
std::string with_place(std::string_view text, const ParsedLine& line);

/// The same in all hints and notices of what came of the line, and in what mends a finding: that is done at
/// the bus of the finding. The family of the line is left out behind a node that the line does not name.
Outcome with_place(Outcome outcome, const ParsedLine& line);

}  // namespace servoctl::cli
