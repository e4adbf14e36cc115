#include "cabinet/cabinet_backup.hpp"

#include "command/cabinet_options.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kCabinetBackupParameters[] = {kAxisOption};

Result<report::Value> run_cabinet_backup(Context& context, const Arguments& arguments) {
  const auto cabinet = context.front_end->cabinet();
  if (!cabinet) return fail(cabinet.error());
  const auto stations = open_stations(context, **cabinet, arguments);
  if (!stations) return fail(stations.error());
  return cabinet::back_up_cabinet(context, **cabinet, *stations, drive::find_families(context.drive_folders));
}

constexpr Example kCabinetBackupExamples[] = {
    {"cabinet backup", "all axes, to a new folder beside the cabinet file"},
    {"cabinet backup --axis feeder,lift", "two of them"},
};

}  // namespace

extern const Command kCabinetBackup;
const Command kCabinetBackup{
    .path = "cabinet backup",
    .summary = "Save the settings of all axes to a dated folder",
    .details =
        "Reads all axes at the same time and saves a backup of each, as `backup` makes it, to a folder next "
        "to the cabinet file: backup-2026-11-22T19-40-00Z/feeder.json, with a copy of the cabinet file. The "
        "folder appears when it is complete. An axis that does not answer, or is another drive than the file "
        "says, is missing in it and is an error. `restore` takes each file, `cabinet diff` compares folders.",
    .parameters = kCabinetBackupParameters,
    .examples = kCabinetBackupExamples,
    .needs = Needs::nothing,
    .effect = Effect::reads,
    .run = run_cabinet_backup,
};

}  // namespace servoctl::commands
