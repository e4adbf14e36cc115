
#include "base/format.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "settings/restore_journal.hpp"
#include "settings/restoring.hpp"
#include "settings/selection.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kRestoreParameters[] = {
    {.name = "file", .help = "a backup, of any format", .kind = Kind::file, .required = true},
    kOnlyOption,
    {.name = "--with-address", .help = "node-ID and bitrate as well", .kind = Kind::flag},
    {.name = "--no-rollback", .help = "leave things as they are when a write fails", .kind = Kind::flag},
    {.name = "--force", .help = "even if identity or family differ", .kind = Kind::flag},
    kSkipInvalidOption,
    kKeepOption,
    kUnlockOption,
    kResumeOption,
};

/// Takes away what does not belong to the part.
Result<void> keep_part(const Context& context, settings::Backup& backup, const std::string& file,
                       std::string_view only) {
  const auto part = settings::selection_of(*context.profile, only);
  if (!part) return fail(part.error());
  if (!*part) return {};
  std::erase_if(backup.entries, [&](const settings::Backup::Entry& entry) { return !(*part)(entry.object); });
  if (!backup.entries.empty()) return {};
  return fail(Errc::usage, message("{} contains nothing of '{}'", as_it_is(file), as_it_is(only)));
}

Result<Value> run_restore(Context& context, const Arguments& arguments) {
  if (context.nodes.size() != 1 || context.nodes.front() == 0)
    return fail(Errc::usage, "restore takes one node: each drive has a backup of its own",
                message("-n {}", node_name(1)));
  if (const auto alone = check_resume(arguments); !alone) return fail(alone.error());
  const std::string file(arguments.text("file"));
  const auto node = context.nodes.front();
  auto backup =
      settings::read_backup(context, file, context.front_end, node, arguments.has("--skip-invalid"));
  if (backup)
    if (const auto kept = keep_part(context, *backup, file, arguments.text("--only")); !kept)
      return fail(kept.error());
  if (!backup) return fail(backup.error());
  auto done = settings::put_into(context, *backup, as_it_is(file), node,
                                 formatted("{}.before-node-{}.json", file, node),
                                 {.choice = {.with_address = arguments.has("--with-address"),
                                             .force = arguments.has("--force"),
                                             .skip_invalid = arguments.has("--skip-invalid")},
                                  .roll_back = !arguments.has("--no-rollback"),
                                  .keep = arguments.has("--keep"),
                                  .unlock = arguments.has("--unlock"),
                                  .resume = arguments.has("--resume")},
                                 settings::journal_of(file));
  if (!done) return fail(done.error());
  return std::move(done->answer);
}

constexpr Example kRestoreExamples[] = {
    {"restore good.json -n 1 -d gsd600 --dry-run", "first: what would be written"},
    {"restore good.json -n 1 -d gsd600 --keep", "all of it or nothing, kept over power-off"},
    {"restore good.json --only params -n 2 -d gsd600", "the panel parameters alone, to another drive"},
};

}  // namespace

extern const Command kRestore;
const Command kRestore{
    .path = "restore",
    .summary = "Restore a backup to a drive: all of it or nothing",
    .details =
        "Takes a backup of any format, a DCF or concise DCF of another tool, or a part of it (--only). "
        "Checks file, family and identity, shows what differs, saves the drive's present values next to the "
        "backup (FILE.before-node-N.json), writes only what differs and reads each value back, PDOs by the "
        "family's own procedure. If a write fails, the old values are written back; the result says whether "
        "all of them were. --keep stores, at the end and only if all is well; where a switch chooses between "
        "RAM and flash, each value goes to the flash as it is written, and a drive that worked in RAM gets "
        "the old ones back in its RAM alone. Node-ID and bitrate stay "
        "unless --with-address is given; COB-IDs follow the node they go to. While it runs it keeps a "
        "journal next to that file: after a pulled cable or a crash --resume continues in the same drive, and "
        "restoring FILE.before-node-N.json undoes everything. Values of another drive or bus in that file are "
        "not replaced: the old ones go to FILE.before-node-N-drive-2.json then. A COB-ID that CiA 301 reserves "
        "for another service is "
        "refused. A value of a servoctl backup outside its limits is listed and not written (exit code 1), "
        "the rest restored; another tool's file with unusable entries, or entries this drive cannot take, is "
        "refused; --skip-invalid lists and skips them.",
    .parameters = kRestoreParameters,
    .examples = kRestoreExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::stores,
    .run = run_restore,
    .on_registers = true,
};

}  // namespace servoctl::commands
