#include <fmt/format.h>

#include "command/command.hpp"
#include "session/serve.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kParameters[] = {
    {.name = "drives", .help = "gsd600@1,gsd600@2?state=FILE", .kind = Kind::text, .required = true},
};

Result<report::Value> run(Context& context, const Arguments& arguments) {
  if (context.session->url().starts_with("sim:"))
    return fail(Errc::usage, "a simulated drive cannot be put on a bus that is simulated itself",
                "use a bus others can reach: vcan0 or local:NAME");
  auto cell = sim::build_cell(arguments.text("drives"), context.drive_folders, context.session->now());
  if (!cell) return fail(cell.error());
  report::List nodes;
  for (const auto& drive : cell->drives) nodes.emplace_back(drive->node());
  const auto count = nodes.size();
  context.emit(
      {{"bus", context.session->url()}, {"nodes", std::move(nodes)}},
      fmt::format("{} drive{} on {}; Ctrl-C ends it", count, count == 1 ? "" : "s", context.session->url()));
  if (context.dry_run) return report::Value();
  if (const auto served = session::serve(*context.session, *cell); !served) return fail(served.error());
  return report::Value();
}

}  // namespace

extern const Command kSim;
const Command kSim{
    .path = "sim",
    .summary = "Put simulated drives on a bus until Ctrl-C",
    .details =
        "For trials without hardware: `servoctl sim gsd600@1 --bus local:cell` in one terminal, commands "
        "with --bus local:cell in another. Options after `?`, separated by `&`: state=FILE keeps the drives' "
        "memory, fault=0xFF00@2s raises a fault, silent=5s silences them after 5 s, delay=20ms delays "
        "answers; counts=8388608 sets the counts per revolution where no object reports them.",
    .parameters = kParameters,
    .needs = Needs::can,
    .effect = Effect::none,
    .run = run,
};

}  // namespace servoctl::commands
