#include "command/command.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kRunParameters[] = {
    {.name = "file",
     .help = "file of command lines; - is standard input",
     .kind = Kind::file,
     .required = true},
    {.name = "--var",
     .help = "NAME=VALUE: a variable, overrides `set` in the file; may be repeated",
     .kind = Kind::text,
     .repeats = true},
    {.name = "--frames",
     .help = "with --dry-run: the frames of every line, for the present state of the drives",
     .kind = Kind::flag},
    {.name = "--restricted",
     .help = "only this bus and files below the folder of FILE; `--yes` in the file does not count",
     .kind = Kind::flag},
    {.name = "--check", .help = "check all lines without a bus, run none", .kind = Kind::flag},
};

constexpr Example kRunExamples[] = {
    {"run setup.servoctl --check", "look for mistakes in every line, without a bus"},
    {"run setup.servoctl --dry-run --frames --var NODE=1", "show the frames of every line"},
    {"run setup.servoctl --var NODE=1 --yes", "run it for node 1, with every question answered by yes"},
};

}  // namespace

extern const Command kRun;
const Command kRun{
    .path = "run",
    .summary = "Run the command lines of a file",
    .details =
        "One command per line, as at the prompt (use, drive and bus too); `#` begins a comment, `\\` at the "
        "end of a line continues it. Also: `set NAME=VALUE` and ${NAME}; `for NODE in 1-8` … `end`, also "
        "over words or over `axes.csv`, whose columns are ${ROW.column}; `expect [0].value == 400` checks "
        "the result of the previous line; `wait 2s`; `pause \"TEXT\"` on a terminal; `on-error continue` or "
        "`stop`. Lines in CiA 309-3 format (`4 r 0x1017 0 u16`) are accepted. Options given here apply to "
        "all lines. Errors in any line are reported before the first one is run; --dry-run shows all lines "
        "with their variables filled in and sends nothing; with --frames every line that changes a drive "
        "also shows its frames, as its own --dry-run would, or why it would be refused, against the drives "
        "as they are before the first line. --restricted is for a file of somebody else: its lines reach no other "
        "bus than that of the run (without --bus: those of the cabinet file), read and write no file outside of the folder of the file, serve no bus to others and "
        "change no interface. `servoctl -` reads standard input.",
    .parameters = kRunParameters,
    .examples = kRunExamples,
    .of_front_end = true,
};

}  // namespace servoctl::commands
