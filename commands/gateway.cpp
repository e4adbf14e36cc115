#include <set>

#include "base/format.hpp"
#include "base/version.hpp"
#include "command/command.hpp"
#include "motion/abandoned.hpp"
#include "session/serve_gateway.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr std::string_view kAllowed[] = {"write"};

constexpr Parameter kGatewayParameters[] = {
    {.name = "--listen",
     .help = "127.0.0.1:60000 (default), or a path such as /run/gateway for a local socket",
     .kind = Kind::text},
    {.name = "--allow",
     .help = "write: clients may write objects and send NMT commands; without it they only read",
     .kind = Kind::choice,
     .choices = kAllowed},
};

/// Whoever reaches the gateway can do it: there is no login.
Result<void> confirm_open(const Context& context, const gateway::Address& address, bool writes) {
  if (!address.is_local())
    if (const auto sure = context.confirm(formatted(
            "Listen at {}? CiA 309-3 has neither login nor encryption: whoever reaches this port can {} every "
            "object of every drive on {}.",
            address.text(), writes ? "read and write" : "read", context.session->url()));
        !sure)
      return sure;
  if (!writes) return {};
  return context.confirm(
      formatted("Let every client at {} write to the drives on {} and send NMT commands? They can energise "
                "and move motors.",
                address.text(), context.session->url()));
}

report::Record description(const Context& context, const gateway::Address& address, bool writes) {
  return {{"bus", context.session->url()}, {"listen", address.text()}, {"writes", writes}};
}

void stop_and_tell(Context& context, motion::PowerWrites& written, const std::set<std::uint8_t>& nodes) {
  const auto before = context.errors.size();
  motion::stop_abandoned(context, nodes);
  written.end(context, nodes);
  for (auto at = before; at < context.errors.size(); ++at)
    context.tell("error: " + context.errors[at].message.text() + "\n");
}

/// `0.1` of 0.1.0: all that `info version` has room for.
std::string two_numbers(std::string_view number) {
  return std::string(number.substr(0, number.find('.', number.find('.') + 1)));
}

Result<void> serve(Context& context, gateway::Listener& listener, bool writes) {
  motion::PowerWrites written;
  session::GatewayServer server(
      *context.session,
      {.writes = writes,
       .version = two_numbers(version()),
       .tell = [&](std::string_view line) { context.tell(formatted("notice: {}\n", line)); },
       .energises = [&](auto node, auto object,
                        auto data) { return written.note(context.profile, node, object, data); },
       .stop = [&](const auto& nodes) { stop_and_tell(context, written, nodes); }});
  auto served = session::serve_gateway(*context.session, listener, server);
  // Over a lost bus nothing can be stopped: the front end says so, and tries when it is back.
  const bool lost = !served && served.error().code == Errc::bus;
  if (const auto nodes = server.energised(); !lost && !nodes.empty()) {
    motion::stop_abandoned(context, nodes);
    written.end(context, nodes);
  }
  return served;
}

Result<report::Value> run_gateway(Context& context, const Arguments& arguments) {
  const auto place = arguments.has("--listen") ? arguments.text("--listen") : "127.0.0.1:60000";
  const auto address = gateway::parse_place(place);
  if (!address) return fail(address.error());
  const bool writes = arguments.has("--allow");
  auto told = description(context, *address, writes);
  if (context.dry_run) return report::Value(std::move(told));
  if (const auto sure = confirm_open(context, *address, writes); !sure) return fail(sure.error());
  const auto listener = gateway::Listener::open(*address);
  if (!listener) return fail(listener.error());
  context.front_end->wait_for_no_reader();
  context.emit(told, formatted("gateway of {} at {}, {}; Ctrl-C ends it", context.session->url(),
                               address->text(), writes ? "clients may write" : "read only"));
  if (const auto served = serve(context, **listener, writes); !served) return fail(served.error());
  return report::Value();
}

constexpr Example kGatewayExamples[] = {
    {"gateway -b can0", "at 127.0.0.1:60000, read only, until Ctrl-C"},
    {"gateway -b can0 --listen /run/gateway", "a local socket: who may write to its file may connect"},
    {"gateway -b can0 --allow write", "clients may write and send NMT commands; asks first"},
};

}  // namespace

extern const Command kGateway;
const Command kGateway{
    .path = "gateway",
    .summary = "Let clients of CiA 309-3, such as cocomm, use the bus until Ctrl-C",
    .details =
        "The ASCII form: lines such as `[1] 4 r 0x1017 0 u16`, answered by `[1] 1000` or `[1] ERROR:0x06020000`. "
        "CiA 309-3 has neither login nor encryption, so it listens on this machine alone unless --listen names "
        "another address, and asks before that; a script needs --yes. Clients only read unless --allow write "
        "is given, which is asked for too: a write or an NMT command is refused with ERROR:102. A drive that a "
        "client enables by 6040h is stopped and disabled when that client goes, or the gateway ends; with -d FAMILY "
        "one that it energised by a parameter of that family too. PDOs, "
        "LSS, guarding and events are not part of it. `help` on the line lists what is. To use the gateway of "
        "another program, name it as a bus: --bus gateway://HOST:60000.",
    .parameters = kGatewayParameters,
    .examples = kGatewayExamples,
    .needs = Needs::bus,
    .effect = Effect::moves,
    .family = FamilyCheck::never,
    .reads_without = "--allow",
    .run = run_gateway,
};

}  // namespace servoctl::commands
