#pragma once

#include <string>
#include <string_view>

namespace servoctl::report {

/// The text with the marks beside Chinese as Chinese writes them: `状态, 故障 (pp)` is `状态，故障（pp）`.
/// What stands between figures and Latin words, in quotes or in backticks stays; a mark and its blank are as
/// wide as before.
std::string chinese_marks(std::string_view text);

}  // namespace servoctl::report
