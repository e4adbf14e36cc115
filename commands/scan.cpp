#include "session/scan.hpp"

#include "canopen/node_list.hpp"
#include "command/command.hpp"
#include "session/identify.hpp"
#include "show/identity.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

Result<report::Value> run(Context& context, const Arguments&) {
  auto nodes = context.nodes_typed ? context.nodes : std::vector<std::uint8_t>();
  if (nodes.empty() || nodes.front() == 0) nodes = canopen::every_node_id();
  auto found = session::scan(*context.session, nodes);
  if (!found) return fail(found.error());
  if (found->empty()) {
    context.errors.push_back(make_error(
        Errc::timeout, "no node answered on " + context.session->url(),
        "check power, cable, 120 ohm at both ends, and that the interface has the drives' bitrate; a stopped "
        "node does not answer: `nmt preop -n all`"));
  }
  const auto families = drive::find_families(context.drive_folders);
  session::look_for_families(*context.session, *found, families);
  return report::Value(show::identity_table(*found, families));
}

}  // namespace

extern const Command kScan;
const Command kScan{
    .path = "scan",
    .summary = "Find the nodes on the bus and what they are",
    .details =
        "Reads object 1000h of nodes 1 to 127, or of the --node in the line itself, all at the same time: "
        "the scan takes one timeout however many there are. Families are identified by the identity and, "
        "where that is not enough, by reading two or three objects that only they have; `?` marks an "
        "unproven guess. cia402 fits every drive of that profile: it is listed where nothing else fits, and "
        "always by `info` and in JSON.",
    .parameters = {},
    .needs = Needs::bus,
    .effect = Effect::reads,
    .run = run,
};

}  // namespace servoctl::commands
