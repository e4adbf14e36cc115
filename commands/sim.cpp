#include <utility>

#include "base/format.hpp"
#include "command/command.hpp"
#include "session/open_port.hpp"
#include "session/open_register_line.hpp"
#include "session/serve.hpp"
#include "session/serve_registers.hpp"
#include "session/serve_ring.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kSimParameters[] = {
    {.name = "drives", .help = "gsd600@1,gsd600@2?state=FILE", .kind = Kind::text, .required = true},
};

void tell_simulated(const Context& context, std::string_view url, report::List nodes) {
  const auto count = nodes.size();
  context.front_end->wait_for_no_reader();
  context.emit({{"bus", std::string(url)}, {"nodes", std::move(nodes)}},
               formatted("{} drive{} on {}; Ctrl-C ends it", count, count == 1 ? "" : "s", url));
}

Result<void> run_on_can(Context& context, std::string_view drives) {
  const auto session = context.front_end->open_bus();
  if (!session) return fail(session.error());
  auto cell = sim::build_cell(drives, context.drive_folders, (*session)->now());
  if (!cell) return fail(cell.error());
  report::List nodes;
  for (const auto& drive : cell->drives) nodes.emplace_back(drive->node());
  tell_simulated(context, (*session)->url(), std::move(nodes));
  if (context.dry_run) return {};
  return session::serve(**session, *cell);
}

Result<void> run_on_ethercat(Context& context, std::string_view drives, std::string_view url) {
  const auto end = context.front_end->open_ring_end();
  if (!end) return fail(end.error());
  auto cell = sim::build_esc_cell(drives, context.drive_folders, (*end)->now());
  if (!cell) return fail(cell.error());
  report::List nodes;
  for (const auto& slave : cell->slaves) nodes.emplace_back(slave->model().node());
  tell_simulated(context, url, std::move(nodes));
  if (context.dry_run) return {};
  auto served = (*end)->serve(*cell);
  (*end)->close();
  return served;
}

Result<void> run_on_modbus(Context& context, std::string_view drives, std::string_view url) {
  const auto end = context.front_end->open_register_end();
  if (!end) return fail(end.error());
  auto cell = sim::build_modbus_cell(drives, context.drive_folders, (*end)->now());
  if (!cell) return fail(cell.error());
  report::List nodes;
  for (const auto& unit : cell->units) nodes.emplace_back(unit->unit());
  tell_simulated(context, url, std::move(nodes));
  if (context.dry_run) return {};
  return (*end)->serve(*cell);
}

Result<report::Value> run_sim(Context& context, const Arguments& arguments) {
  const auto url = context.front_end->bus_url();
  if (url.starts_with("sim:"))
    return fail(Errc::usage, "a simulated drive cannot be put on a bus that is simulated itself",
                "use a bus others can reach: vcan0 or local:NAME");
  const auto drives = arguments.text("drives");
  const auto served = session::is_ethercat(url) ? run_on_ethercat(context, drives, url)
                      : session::is_modbus(url) ? run_on_modbus(context, drives, url)
                                                : run_on_can(context, drives);
  if (!served) return fail(served.error());
  return report::Value();
}

constexpr Example kSimExamples[] = {
    {"sim gsd600@1 -b local:cell", "a drive for other terminals: `scan -b local:cell`"},
    {"sim \"gsd600@1,ts@2?state=memory\" -b local:cell",
     "two that remember what was written in the file memory"},
    {"sim sv2@1,sv2@2 -b coe:local:ring", "an EtherCAT ring"},
};

}  // namespace

extern const Command kSim;
const Command kSim{
    .path = "sim",
    .summary = "Put simulated drives on a bus until Ctrl-C",
    .details =
        "For trials without hardware: `servoctl sim gsd600@1 --bus local:cell` in one terminal, commands "
        "with --bus local:cell in another. Options after `?`, separated by `&`: state=FILE keeps the drives' "
        "memory, fault=0xFF00@2s raises a fault, silent=5s silences them after 5 s, delay=20ms delays "
        "answers, lie=late,twice makes them deviate from the standard (docs/buses.md, docs/modbus.md and "
        "docs/ethercat.md list the words); counts=8388608 sets the counts per revolution where no object reports them; "
        "panel=PA-20=0,P0.03=7 sets parameters as on the panel. "
        "On EtherCAT, `servoctl sim sv2@1,sv2@2 --bus coe:local:cell` (or coe:veth1, one end of a veth pair), "
        "nodes are positions, and more can go wrong: lose=100 loses every 100th frame, short=100 lowers the "
        "working counters of every 100th, cut=2@5s-8s cuts the cable in front of drive 2 and joins it again, "
        "power=1@5s-8s switches drive 1 off and on, fall=5s takes the drives out of OP (fall=0x1B@5s with "
        "this AL status code), free-run=no demands SYNC0, mailbox=full leaves requests unread, emergency=3 "
        "sends emergencies before 3 answers, and the SII is bad by sii=checksum, blank, cut-short, mailboxes "
        "or mute. On Modbus, `servoctl sim ts@1 --bus modbus:/dev/pts/4` stands at one end of a serial line, and "
        "--bus modbus://127.0.0.1:1502 listens there; damage=10 damages every 10th answer.",
    .parameters = kSimParameters,
    .examples = kSimExamples,
    .needs = Needs::bus,
    .effect = Effect::none,
    .run = run_sim,
    .opens_bus = true,
};

}  // namespace servoctl::commands
