
#include "traffic/doctor.hpp"
#include "base/format.hpp"
#include "base/signal_wait.hpp"
#include "can/socketcan.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "session/open_bus.hpp"
#include "session/open_register_line.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Value;
using traffic::Findings;

constexpr Parameter kDoctorParameters[] = {
    {.name = "bus",
     .help = "can0, coe:eth0 (default: --bus, of any kind, or all CAN interfaces)",
     .kind = Kind::bus},
    {.name = "--active", .help = "also ask all nodes for 1000h", .kind = Kind::flag},
    {.name = "--for", .help = "how long to listen to each (default 2s)", .kind = Kind::duration},
};

/// The bus of the line, and no other: a second look at a ring is refused its wire.
Result<Findings> examine_url(Context& context, const std::string& url,
                             const traffic::DoctorOptions& options) {
  if (url.find(':') == std::string::npos) return traffic::examine_link(url, options);
  if (session::is_modbus(url))
    return fail(Errc::usage, "`doctor` looks at CAN and EtherCAT, not at Modbus",
                message("`scan --bus {}` asks all addresses, and says what comes instead of an answer",
                        as_it_is(url)));
  if (session::canonical_url(context.front_end->bus_url()) != url)
    return fail(Errc::usage, message("{} is looked at as the bus of the line", as_it_is(url)),
                message("`doctor --bus {}`", as_it_is(url)));
  const auto session = context.front_end->open_bus();
  if (!session) return fail(session.error());
  return traffic::examine(**session, options);
}

std::vector<std::string> urls_of(const Context& context, const Arguments& arguments) {
  if (arguments.has("bus")) return {session::canonical_url(arguments.text("bus"))};
  if (!context.front_end->bus_url().empty()) return {session::canonical_url(context.front_end->bus_url())};
  return can::can_interfaces();
}

Result<Value> run_doctor(Context& context, const Arguments& arguments) {
  if (arguments.has("--node") && arguments.text("--node") != "all")
    return fail(
        Errc::usage, "`doctor` looks at a bus and all of its nodes, not at one",
        message("`scan -n {}` asks it; leave -n out for the bus", as_it_is(arguments.text("--node"))));
  traffic::DoctorOptions options;
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  if (*length) options.listen = **length;
  options.active = arguments.has("--active");
  options.cancelled = [before = signals_noted()] { return signals_noted() != before; };
  options.told = [&](double share, TimePoint begin, TimePoint now) { context.show_share(share, begin, now); };
  std::vector<Findings> all;
  const auto urls = urls_of(context, arguments);
  for (const auto& url : urls) {
    auto findings = examine_url(context, url, options);
    if (!findings) return fail(findings.error());
    all.push_back(std::move(*findings));
  }
  if (urls.empty()) all.push_back(traffic::examine_machine());
  if (const auto faults = traffic::faults_in(all); faults > 0)
    context.errors.push_back(make_error(
        Errc::negative, faults == 1 ? Message("1 fault was found") : message("{} faults were found", faults),
        "begin with the first; each says what mends it"));
  return findings_value(all);
}

constexpr Example kDoctorExamples[] = {
    {"doctor can0", "look at the interface, listen for two seconds, and say what to mend"},
    {"doctor can0 --active --for 10s", "also ask all nodes, where nobody talks by itself"},
    {"doctor -b coe:eth0", "links, lost frames and error counters of a ring"},
};

}  // namespace

extern const Command kDoctor;
const Command kDoctor{
    .path = "doctor",
    .summary = "Say what is wrong with a bus, and what mends it",
    .details =
        "Looks at the interface (up, bitrate, sample point, state, error counters, restart, queue, rights, driver) and "
        "listens for two seconds: who talks, how loaded the bus is, what goes wrong on the wire. It tells apart: no "
        "adapter, interface down, bus-off, nobody acknowledges (alone on the bus), wrong bitrate (errors and no "
        "frame), bad signal as without a terminator (errors among frames), two nodes of one number, overload. On "
        "EtherCAT it reads registers only: link, lost frames, error counters of each port and whether they go on "
        "counting, slaves that come and go. On CAN nothing is sent; --active also asks all nodes for 1000h, which "
        "shows who does not talk by itself, and lets a controller find out that nobody acknowledges. What is heard of "
        "errors is what the driver tells: many USB adapters tell no errors on the wire, only their counters; one behind "
        "slcan: tells the flags of its controller and no counters, and acknowledges what it hears. `note` is "
        "worth knowing, `fault` is wrong or very likely so. Exit code 1 when there is a fault.",
    .parameters = kDoctorParameters,
    .examples = kDoctorExamples,
    .needs = Needs::nothing,
    .effect = Effect::reads,
    .family = FamilyCheck::never,
    .run = run_doctor,
};

}  // namespace servoctl::commands
