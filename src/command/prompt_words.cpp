#include "command/prompt_words.hpp"

#include <algorithm>
#include <iterator>

namespace servoctl::command {
namespace {

constexpr Example kUseExamples[] = {
    {"use 3", "node 3"},
    {"use 1,3,5-8", "several: each of the following lines goes to all of them"},
    {"use feeder,lift", "axes of the cabinet file by name; with them their bus and family"},
};
constexpr Example kDriveExamples[] = {
    {"drive gsd600", "a family that servoctl knows; `drives` lists them"},
    {"drive gripper.eds", "a drive of another kind, by its EDS"},
};
constexpr Example kBusExamples[] = {
    {"bus can0", "a CAN interface; `bus up can0 --bitrate 500k` brings it up"},
    {"bus coe:eth0", "drives on EtherCAT behind this port"},
    {"bus sim:gsd600@1,ts@2", "two simulated drives, to try things out"},
};
constexpr Example kUndoExamples[] = {
    {"undo", "shows the old values and the new ones, asks, and writes the old ones"},
    {"undo --yes", "the same without the question, in a pipe"},
};
constexpr Example kLogExamples[] = {
    {"log on commissioning.log", "from now on; a file that is there is continued"},
    {"log off", "end it"},
};
constexpr Example kExitExamples[] = {{"exit", "leave the prompt"}};

constexpr PromptWord kPromptWords[] = {
    {.name = "use",
     .argument = "NODE",
     .summary = "Use this node or axis, list or `all` for the following lines",
     .details =
         "Stands for --node of the following lines; a line with -n of its own goes to that. `all` is every node "
         "that answers. Works in a batch file as well.",
     .examples = kUseExamples,
     .is_place = true},
    {.name = "drive",
     .argument = "FAMILY",
     .summary = "Use this drive family for the following lines",
     .details =
         "Stands for --drive of the following lines: a family, an EDS, DCF or ESI file, or `online` for what the "
         "drive says of its own objects. Works in a batch file as well.",
     .examples = kDriveExamples,
     .is_place = true},
    {.name = "bus",
     .argument = "BUS",
     .summary = "Switch to this bus for the following lines",
     .details =
         "Opens the bus, as --bus names it, or by the name it has in the cabinet file. One that cannot be opened "
         "is an error, and the old one stays. Works in a batch file as well.",
     .examples = kBusExamples,
     .is_place = true},
    {.name = "undo",
     .argument = {},
     .summary = "Put back what the last `param set` or `write` replaced",
     .details =
         "Asks first, naming node and values; each value is written and read back as its line was, with --keep and "
         "--unlock where that had them. A second `undo` puts back what the first replaced. Refused, and nothing is "
         "sent, when bus or node in use are others now, the drive is known to have restarted, is another one, or no "
         "longer holds what was written, and for what drives the motor or starts an action. Not in batch files.",
     .examples = kUndoExamples},
    {.name = "log",
     .argument = "on FILE",
     .summary = "Keep all that is typed and answered in a file, until `log off`",
     .details =
         "Each line has its UTC time: behind `> ` what was typed, behind two blanks what was answered. A file that is "
         "there is added to. `log` alone tells where it goes. When the disk is full it is told and the log "
         "ends, not what runs. Not in batch files.",
     .examples = kLogExamples},
    {.name = "exit",
     .argument = {},
     .summary = "Leave the prompt (also quit, or Ctrl-D)",
     .details =
         "SYNC of `sync start` ends with it. A drive that `enable` energised at this prompt is stopped and "
         "disabled, which is told. The next prompt opens where this one was, unless it is told another place.",
     .examples = kExitExamples},
};

}  // namespace

std::span<const PromptWord> prompt_words() { return kPromptWords; }

const PromptWord* find_prompt_word(std::string_view name) {
  const auto* const found =
      std::find_if(std::begin(kPromptWords), std::end(kPromptWords),
                   [&](const PromptWord& word) { return word.name == (name == "quit" ? "exit" : name); });
  return found == std::end(kPromptWords) ? nullptr : found;
}

std::string prompt_usage(const PromptWord& word) {
  return std::string(word.name) + (word.argument.empty() ? "" : " " + std::string(word.argument));
}

}  // namespace servoctl::command
