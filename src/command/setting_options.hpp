#pragma once

#include "command/command.hpp"

/// What commands that write settings have in common on the command line.
namespace servoctl::command {

/// `--keep` and `--unlock`, for the commands that have them.
inline constexpr Parameter kKeepOption{
    .name = "--keep", .help = "make the values survive power-off", .kind = Kind::flag};
inline constexpr Parameter kUnlockOption{
    .name = "--unlock", .help = "unlock by the family's password, lock again after", .kind = Kind::flag};

/// `--skip-invalid`, for the commands that read files of other forms.
inline constexpr Parameter kSkipInvalidOption{
    .name = "--skip-invalid", .help = "skip entries that cannot be used, and list them", .kind = Kind::flag};

/// The option `--only`, for the commands that have it.
inline constexpr Parameter kOnlyOption{
    .name = "--only", .help = "communication, pdo, params, or a group of parameters", .kind = Kind::text};

/// `--resume`, for the commands that restore.
inline constexpr Parameter kResumeOption{
    .name = "--resume", .help = "resume an interrupted run, same options", .kind = Kind::flag};

/// What is gone on with goes on as it was begun: an option that would say otherwise is refused, not dropped.
Result<void> check_resume(const Arguments& arguments);

}  // namespace servoctl::command
