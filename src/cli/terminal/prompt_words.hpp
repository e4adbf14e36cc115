#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/shell.hpp"
#include "cli/terminal/console.hpp"
#include "cli/terminal/line_screen.hpp"

namespace servoctl::cli {

/// Where lines go that name no place, and how it is there: bus, node, family and state; of axes of the
/// cabinet those of the file. `servoctl can0 node 1 gsd600 [operation enabled]> `. A `?` behind the state:
/// it was heard some time ago. In red when a node is in fault. Nothing is asked of a drive for it. `window`:
/// columns of the terminal, in which most are left for what is typed; 0: it is as long as it is.
PromptText prompt_text(Shell& shell, std::size_t window = 0);

/// The same as this terminal shows it: red where there are colours, ASCII where the locale wants it.
PromptText dressed_prompt(Shell& shell, const Console& console);

/// A line that begins with the number of a panel parameter as the command that it stands for: `Pn0214` is
/// `param get Pn0214`, `Pn0214=45Hz` (also with blanks about the sign) is `param set Pn0214=45Hz`. Any other
/// line as it is.
std::vector<std::string> as_parameter_line(std::vector<std::string> words);

/// Whether the line is `exit` or `quit`.
bool is_exit(const std::vector<std::string>& words);

/// Whether the line begins with `use`, `drive` or `bus`.
bool is_choice(const std::vector<std::string>& words);

/// Opens the bus of the settings; a bus of the cabinet by its name. Errors as Shell::open().
Result<session::Session*> open_chosen_bus(Shell& shell, const Settings& settings);

/// Does what `use`, `drive` and `bus` say: they change the defaults of the shell. Empty for any other line.
std::optional<Outcome> choose(Shell& shell, const std::vector<std::string>& words);

/// The defaults after such a line, nothing opened; unchanged after any other one. Errors as choose().
Result<Settings> chosen(Shell& shell, Settings defaults, const std::vector<std::string>& words);

/// Whether the line may have moved a motor.
bool may_move(const std::string& line);

}  // namespace servoctl::cli
