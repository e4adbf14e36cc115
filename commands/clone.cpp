#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/node_list.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "settings/restoring.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kCloneParameters[] = {
    {.name = "--from", .help = "node whose settings are taken", .kind = Kind::number, .required = true},
    {.name = "--to", .help = "nodes that get them: 2,3,5-8", .kind = Kind::text, .required = true},
    {.name = "--force", .help = "even if identities differ", .kind = Kind::flag},
    kKeepOption,
    kUnlockOption,
    kResumeOption,
};

constexpr std::string_view kNodesHint = "write 2, 2,3,4 or 2-4; node-IDs are 1 to 127";

Result<Value> run_clone(Context& context, const Arguments& arguments) {
  if (const auto alone = check_resume(arguments); !alone) return fail(alone.error());
  const auto from = canopen::parse_node_ids(arguments.text("--from"), kNodesHint);
  if (!from) return fail(from.error());
  const auto to = canopen::parse_node_ids(arguments.text("--to"), kNodesHint);
  if (!to) return fail(to.error());
  if (from->size() != 1) return fail(Errc::usage, "--from takes one node");
  if (std::find(to->begin(), to->end(), from->front()) != to->end())
    return fail(Errc::usage, message("node {} cannot be cloned into itself", node_name(from->front())));
  std::vector<std::uint8_t> all = *to;
  all.push_back(from->front());
  if (const auto right = context.hold_family(all, context.profile, true); !right) return fail(right.error());
  const auto snapshot = session::take_snapshots(*context.session, *context.profile, *from, {}).front();
  if (!snapshot) return fail(snapshot.error());
  const auto backup = settings::make_backup(context, *snapshot);
  settings::tell_left_out(context, backup);
  report::List out;
  bool failed = false;
  for (std::size_t i = 0; i < to->size() && !failed; ++i) {
    const auto node = (*to)[i];
    auto done = settings::put_into(context, backup, message("node {}", node_name(from->front())), node,
                                   formatted("before-clone-node-{}.json", node),
                                   {.choice = {.force = arguments.has("--force")},
                                    .keep = arguments.has("--keep"),
                                    .unlock = arguments.has("--unlock"),
                                    .resume = arguments.has("--resume")});
    // One that went wrong ends the work: the others stay as they are.
    if (!done && out.empty()) return fail(done.error());
    if (!done) {
      context.errors.push_back(done.error());
      break;
    }
    out.push_back(std::move(done->answer));
    failed = done->failed;
  }
  return Value(std::move(out));
}

constexpr Example kCloneExamples[] = {
    {"clone --from 1 --to 2,3 -d gsd600", "show what differs, ask, and write it"},
    {"clone --from 1 --to 2-5 --keep -d gsd600", "kept over power-off"},
};

}  // namespace

extern const Command kClone;
const Command kClone{
    .path = "clone",
    .summary = "Copy the settings of one drive to others",
    .details =
        "Backup and restore in one, with the same care: each target is checked, the differences are shown "
        "and confirmed, its old values go to before-clone-node-N.json in the current folder (where that has "
        "another drive's, to before-clone-node-N-drive-2.json), and a failure writes them back and stops. "
        "Node-ID and bitrate stay; COB-IDs follow the target's node-ID.",
    .parameters = kCloneParameters,
    .examples = kCloneExamples,
    .needs = Needs::bus | Needs::dictionary,
    .effect = Effect::stores,
    .run = run_clone,
    .on_registers = true,
};

}  // namespace servoctl::commands
