#include "cabinet/cabinet_diff.hpp"

#include "command/command.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kCabinetDiffParameters[] = {
    {.name = "a",
     .help = "a cabinet file, or a folder of `cabinet backup`",
     .kind = Kind::file,
     .required = true},
    {.name = "b",
     .help = "a cabinet file, or a folder of `cabinet backup`",
     .kind = Kind::file,
     .required = true},
};

Result<report::Value> run_cabinet_diff(Context& context, const Arguments& arguments) {
  return cabinet::compare_cabinets(
      context, std::filesystem::path(arguments.text("a")), std::filesystem::path(arguments.text("b")),
      [&](const std::string& family) { return context.front_end->family(family); });
}

constexpr Example kCabinetDiffExamples[] = {
    {"cabinet diff cabinet.toml backup-2026-11-22T19-40-00Z",
     "the file against what was saved of the drives"},
    {"cabinet diff monday.toml cabinet.toml", "two files"},
};

}  // namespace

extern const Command kCabinetDiff;
const Command kCabinetDiff{
    .path = "cabinet diff",
    .summary = "Compare two cabinet files, or backups of all axes",
    .details =
        "Two of: a cabinet file, a folder of `cabinet backup`. Two folders are compared value by value, two "
        "files by what they say of each axis, and a folder with a file by what the file says of the drive "
        "that was saved. Lists every difference with its axis; exit code 1 if there is one. No bus is needed.",
    .parameters = kCabinetDiffParameters,
    .examples = kCabinetDiffExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_cabinet_diff,
};

}  // namespace servoctl::commands
