#include "command/command.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kParameters[] = {
    {.name = "file",
     .help = "file of command lines; - is standard input",
     .kind = Kind::file,
     .required = true},
    {.name = "--var",
     .help = "NAME=VALUE: a variable of the file, over its own `set`; may be repeated",
     .kind = Kind::text,
     .repeats = true},
    {.name = "--frames",
     .help = "with --dry-run: the frames of every line, by the state the drives are in now",
     .kind = Kind::flag},
    {.name = "--check", .help = "check all lines without a bus, run none", .kind = Kind::flag},
};

}  // namespace

extern const Command kRun;
const Command kRun{
    .path = "run",
    .summary = "Run the command lines of a file",
    .details =
        "One command line a line, as at the prompt (use, drive and bus too); `#` begins a comment, `\\` at "
        "the end of a line continues it. Also: `set NAME=VALUE` and ${NAME}; `for NODE in 1-8` … `end`, also "
        "over words or over `axes.csv`, whose columns are ${ROW.column}; `expect [0].value == 400` asks the "
        "result of the line before; `wait 2s`; `pause \"TEXT\"` on a terminal; `on-error continue` or "
        "`stop`. Lines in the form of CiA 309-3 (`4 r 0x1017 0 u16`) are understood. Options given here hold "
        "for all lines. What is wrong in any line is told before the first one is run; --dry-run shows all "
        "lines with their variables filled in and sends nothing; with --frames every line that changes a "
        "drive is gone through as with its own --dry-run, against the drives as they are before the first "
        "line, and shows its frames or why it would be refused. `servoctl -` reads standard input.",
    .parameters = kParameters,
    .of_front_end = true,
};

}  // namespace servoctl::commands
