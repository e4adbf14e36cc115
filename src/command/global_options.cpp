#include "command/command.hpp"
#include "command/output_form.hpp"

namespace servoctl::command {
namespace {

constexpr std::string_view kLanguages[] = {"en", "zh"};

constexpr std::string_view kColours[] = {"auto", "always", "never"};

constexpr Parameter kGlobal[] = {
    {.name = "--bus",
     .help =
         "bus: can0, slcan:PORT@500k, socketcand://HOST/can0, local:NAME, sim:gsd600@1 (default $SERVOCTL_BUS)",
     .kind = Kind::bus,
     .short_name = "-b"},
    {.name = "--node",
     .help = "node-ID, a list 1,3,5-8, axes by name, or all (default $SERVOCTL_NODE)",
     .kind = Kind::nodes,
     .short_name = "-n"},
    {.name = "--drive",
     .help =
         "drive family, an .eds, .dcf or .xml file, or online: the drive itself (default $SERVOCTL_DRIVE)",
     .kind = Kind::family,
     .short_name = "-d"},
    {.name = "--cabinet",
     .help = "cabinet file: axes by name (default $SERVOCTL_CABINET, or cabinet.toml here or above)",
     .kind = Kind::file},
    {.name = "--timeout", .help = "longest wait for one answer (default 500ms)", .kind = Kind::duration},
    {.name = "--retries",
     .help = "retries of an unanswered read (default 1); a write is never repeated",
     .kind = Kind::number},
    {.name = "--json", .help = "one JSON document instead of text", .kind = Kind::flag},
    {.name = "--output",
     .help = "text, json, or jsonl for one document per sample",
     .kind = Kind::choice,
     .choices = kOutputForms,
     .short_name = "-o"},
    {.name = "--lang",
     .help = "language of what people read: en or zh (default $SERVOCTL_LANG)",
     .kind = Kind::choice,
     .choices = kLanguages},
    {.name = "--color",
     .help = "colours: auto (on a terminal, unless NO_COLOR is set), always or never",
     .kind = Kind::choice,
     .choices = kColours},
    {.name = "--no-pager",
     .help = "no pager for what is longer than the window (default $SERVOCTL_PAGER, $PAGER, less -FRX)",
     .kind = Kind::flag},
    {.name = "--yes", .help = "answer yes to every question", .kind = Kind::flag, .short_name = "-y"},
    {.name = "--quiet",
     .help = "no notices and no progress on stderr; errors stay",
     .kind = Kind::flag,
     .short_name = "-q"},
    {.name = "--verbose",
     .help = "tell on stderr what is done: bus, family, each object that is read or written",
     .kind = Kind::flag,
     .short_name = "-v"},
    {.name = "--force-family",
     .help = "continue although the drive's identity contradicts -d; --yes does not imply it",
     .kind = Kind::flag},
    {.name = "--read-only", .help = "refuse what changes a drive or replaces a file", .kind = Kind::flag},
    {.name = "--dry-run", .help = "show the frames, send nothing that changes a drive", .kind = Kind::flag},
    {.name = "--trace", .help = "write every frame to a file (candump -L format)", .kind = Kind::file},
    {.name = "--help", .help = "show the help of the command", .kind = Kind::flag, .short_name = "-h"},
};

}  // namespace

std::span<const Parameter> global_options() { return kGlobal; }

}  // namespace servoctl::command
