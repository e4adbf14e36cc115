#include <fmt/format.h>

#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "settings/change.hpp"
#include "settings/restore_journal.hpp"
#include "settings/restoring.hpp"
#include "settings/selection.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kParameters[] = {
    {.name = "file", .help = "a backup, of any format", .kind = Kind::file, .required = true},
    kOnlyOption,
    {.name = "--with-address", .help = "node-ID and bitrate as well", .kind = Kind::flag},
    {.name = "--no-rollback", .help = "leave things as they are when a write fails", .kind = Kind::flag},
    {.name = "--force", .help = "although identity or family are others", .kind = Kind::flag},
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
  return fail(Errc::usage, fmt::format("{} has nothing of '{}'", file, only));
}

Result<Value> run(Context& context, const Arguments& arguments) {
  if (context.nodes.size() != 1 || context.nodes.front() == 0)
    return fail(Errc::usage, "restore takes one node: each drive has a backup of its own", "-n 1");
  if (const auto alone = check_resume(arguments); !alone) return fail(alone.error());
  const std::string file(arguments.text("file"));
  const auto node = context.nodes.front();
  auto backup =
      settings::read_backup(context, file, context.front_end, node, arguments.has("--skip-invalid"));
  if (backup)
    if (const auto kept = keep_part(context, *backup, file, arguments.text("--only")); !kept)
      return fail(kept.error());
  if (!backup) return fail(backup.error());
  auto done =
      settings::put_into(context, *backup, file, node, fmt::format("{}.before-node-{}.json", file, node),
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

}  // namespace

extern const Command kRestore;
const Command kRestore{
    .path = "restore",
    .summary = "Put a backup into a drive: all of it or nothing",
    .details =
        "Takes a backup of any format, a DCF or concise DCF of another tool, or a part of it (--only). "
        "Checks file, family and identity, shows what differs, saves what the drive holds beside the backup "
        "(FILE.before-node-N.json), writes only what differs and reads each value back, PDOs by the "
        "procedure of CiA 301. When a write fails, what was written is put back; the answer says how things "
        "stand. Stores with --keep, at the end and only if all is well. Node-ID and bitrate stay unless "
        "--with-address is given; COB-IDs follow the node they go to. While it runs a journal stands beside "
        "that file: after a pulled cable or a crash --resume goes on, and restoring FILE.before-node-N.json "
        "takes everything back. A COB-ID that CiA 301 keeps for another service is refused. A value of a "
        "backup of ours outside of the limits is named and left as it is (exit code 1), the rest restored; "
        "entries of another tool's file that cannot be used, or not by this drive, are refused, and with "
        "--skip-invalid named and left out.",
    .parameters = kParameters,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::stores,
    .run = run,
};

}  // namespace servoctl::commands
