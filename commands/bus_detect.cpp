#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "base/signal_wait.hpp"
#include "can/slcan_link.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "command/interface_option.hpp"
#include "drive/bitrate.hpp"
#include "session/bitrate_search.hpp"
#include "session/bus_setup.hpp"
#include "session/open_bus.hpp"
#include "session/own_bitrate.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Show;
using report::Value;
using session::Heard;

constexpr Parameter kBusDetectParameters[] = {
    kInterface,
    {.name = "--for", .help = "how long to listen at each bitrate (default 2s)", .kind = Kind::duration},
    {.name = "--bitrate",
     .help = "listen at this bitrate only; may be given several times (default: those of CiA 301, and 100k)",
     .kind = Kind::text,
     .repeats = true},
};

Result<session::SearchOptions> search_options(const Context& context, const Arguments& arguments) {
  session::SearchOptions out;
  const auto each = duration_option(arguments, "--for");
  if (!each) return fail(each.error());
  if (*each) out.each = **each;
  for (const auto& text : arguments.all("--bitrate")) {
    const auto bitrate = drive::parse_bitrate(text);
    if (!bitrate) return fail(bitrate.error());
    out.bitrates.push_back(*bitrate);
  }
  const auto usual = session::usual_bitrates();
  if (out.bitrates.empty()) out.bitrates.assign(usual.begin(), usual.end());
  out.cancelled = [before = signals_noted()] { return signals_noted() != before; };
  out.listening = [&](double share, TimePoint begin, TimePoint now) {
    context.show_share(share, begin, now);
  };
  return out;
}

report::List bitrate_row(const Heard& heard) {
  return {heard.bitrate, drive::bitrate_text(heard.bitrate), name(heard.verdict), heard.frames, heard.errors};
}

report::Table bitrates_table(const session::Search& search) {
  report::Table out;
  out.columns = {{"bitrate", "", Show::json},
                 {"bitrate_text", "bitrate", Show::text},
                 {"heard"},
                 {"frames"},
                 {"errors"}};
  for (const auto& heard : search.heard) out.rows.push_back(bitrate_row(heard));
  return out;
}

std::string question_bus_detect(const std::string& name, const can::LinkState& before) {
  const auto how = session::settings_text(before);
  auto out = formatted("Take {} down to listen at other bitrates? It is up{}{}", name,
                       how.empty() ? "" : " at ", how);
  if (const auto who = who_receives(name); !who.empty()) out += "; " + who;
  return out + ". It is put back afterwards.";
}

/// What is listened with.
struct Listener {
  std::unique_ptr<can::LinkControl> link;
  std::optional<can::SlcanPlace> serial;  ///< An adapter behind `slcan:`.

  const std::string& name() const { return link->name(); }
  /// The bus at a bitrate, as it is named from then on.
  std::string bus_at(std::uint32_t bitrate) const {
    if (!serial) return name();
    auto place = *serial;
    place.bitrate = bitrate;
    return can::slcan_url(place);
  }
};

Result<Listener> listener_of(const Arguments& arguments) {
  const auto url = session::canonical_url(arguments.text("interface"));
  if (const auto own = session::check_own_bitrate(url, "bus detect"); !own) return fail(own.error());
  Listener out;
  constexpr std::string_view kSerial = "slcan:";
  if (!url.starts_with(kSerial)) {
    auto link = can::open_link(url);
    if (!link) return fail(link.error());
    out.link = std::move(*link);
    return out;
  }
  auto place = can::parse_slcan_port(url.substr(kSerial.size()));
  if (!place) return fail(place.error());
  out.link = std::make_unique<can::SlcanLink>(*place);
  out.serial = std::move(*place);
  return out;
}

/// What the silence, or the noise, means.
Error no_bitrate_found(const Listener& listener, const session::Search& search) {
  const auto& name = listener.name();
  const bool noise = std::any_of(search.heard.begin(), search.heard.end(),
                                 [](const Heard& heard) { return heard.verdict == Heard::Verdict::errors; });
  if (noise)
    return make_error(
        Errc::negative,
        message("no bitrate was found on {}: errors were heard, and no frame at any bitrate", as_it_is(name)),
        "somebody talks: check CAN_H and CAN_L for being crossed, the 120 ohm at both ends, and that "
        "all nodes have one bitrate; another one than the usual ones: --bitrate 83333");
  return make_error(
      Errc::negative, message("no bitrate was found on {}: nobody talks", as_it_is(name)),
      message(
          "drives that send nothing by themselves cannot be heard: switch one off and on while this runs (its "
          "boot-up is a frame), listen longer (--for 10s), or ask at each bitrate with `scan --all-bitrates "
          "--bus {}`; then check power, cable and plug",
          as_it_is(listener.bus_at(500'000))));
}

/// Where it stands if the process is killed in between.
void tell_before(const Context& context, const std::string& name, const can::LinkState& before) {
  const auto how = session::settings_text(before);
  context.tell(formatted("{} was {}{}{}; it is put back to that\n", name, before.up ? "up" : "down",
                         how.empty() ? "" : " with ", how));
}

/// An interface that is in use is asked for; the bus of this prompt that has the adapter is closed.
Result<void> take_interface(Context& context, const Listener& listener, const can::LinkState& before) {
  const auto& name = listener.name();
  const bool is_ours = listener.serial && context.front_end->has_adapter(name);
  if (before.up || is_ours) {
    if (const auto held = hold_energised(context, name); !held) return held;
    const auto question = is_ours
                              ? formatted(
                                    "Close the bus of this prompt over {} to listen at other bitrates? The "
                                    "next line that needs it opens it again.",
                                    name)
                              : question_bus_detect(name, before);
    if (const auto agreed = context.confirm(question); !agreed) return agreed;
  }
  if (is_ours) return context.front_end->release_adapter(name);
  if (!listener.serial) tell_before(context, name, before);
  return {};
}

Value planned_search(const std::vector<std::uint32_t>& bitrates) {
  session::Search plan;
  for (const auto bitrate : bitrates) plan.heard.push_back({.bitrate = bitrate});
  auto table = bitrates_table(plan);
  table.columns.resize(2);
  for (auto& row : table.rows) row.resize(2);
  return Value(std::move(table));
}

void tell_next(Context& context, const Listener& listener, const can::LinkState& before,
               std::uint32_t bitrate) {
  const auto& name = listener.name();
  if (listener.serial)
    context.notices.push_back(message("{} is closed again; `-b {}` takes part in the bus", as_it_is(name),
                                      as_it_is(listener.bus_at(bitrate))));
  else if (!before.up || before.bitrate != bitrate)
    context.notices.push_back(
        message("{} was put back to what it was; `bus up {} --bitrate {}` takes part in the bus",
                as_it_is(name), as_it_is(name), bitrate));
}

Result<Value> run_bus_detect(Context& context, const Arguments& arguments) {
  auto options = search_options(context, arguments);
  if (!options) return fail(options.error());
  const auto listener = listener_of(arguments);
  if (!listener) return fail(listener.error());
  const auto before = listener->link->state();
  if (!before) return fail(before.error());
  if (context.dry_run) return planned_search(options->bitrates);
  if (const auto taken = take_interface(context, *listener, *before); !taken) return fail(taken.error());
  const auto hold = context.front_end->protect();  // The interface is put back on every way out.
  const auto search = session::search_bitrate(*listener->link, *options);
  if (!search) return fail(search.error());
  if (!search->bitrate) context.errors.push_back(no_bitrate_found(*listener, *search));
  report::Record out{
      {"interface", listener->name()},
      {"bitrate", search->bitrate ? Value(*search->bitrate) : Value(), Show::json},
      {"bitrate_text", search->bitrate ? Value(drive::bitrate_text(*search->bitrate)) : Value("not found"),
       Show::text, "bitrate"},
      {"heard", bitrates_table(*search)}};
  if (search->bitrate) tell_next(context, *listener, *before, *search->bitrate);
  return Value(std::move(out));
}

Result<void> check_bus_detect(Context& context, const Arguments& arguments) {
  const auto url = session::canonical_url(arguments.text("interface"));
  if (const auto own = session::check_own_bitrate(url, "bus detect"); !own) return own;
  const auto options = search_options(context, arguments);
  return options ? Result<void>() : fail(options.error());
}

constexpr Example kBusDetectExamples[] = {
    {"bus detect can0", "listen at one bitrate after the other; nothing is sent"},
    {"bus detect can0 --bitrate 500k --bitrate 1M --for 5s",
     "at these two, five seconds each, where drives seldom speak"},
    {"bus detect slcan:/dev/ttyACM0", "an adapter behind slcan:, in its listen-only mode"},
};

}  // namespace

extern const Command kBusDetect;
const Command kBusDetect{
    .path = "bus detect",
    .summary = "Find the bitrate of a bus by listening",
    .details =
        "Listens at one bitrate after the other and sends nothing, not even an acknowledge (the listen-only mode of "
        "the controller; where its driver has none, it refuses): 500k, 1M, 250k, 125k, 800k, 100k, 50k, 20k, 10k. It "
        "ends with the first at which frames come. An interface that is up has to be taken down for it, which asks "
        "first and needs --yes in a script. On every way out, Ctrl-C too, the interface is put back to what it was; "
        "one that never had a bitrate keeps the last and is down. Where it was killed, `bus up` ends the listening. "
        "An adapter behind slcan: is named by its port and is closed afterwards; how its bus is called from then on "
        "is told. "
        "Drives that send nothing by themselves cannot be heard. Exit code 1 when no bitrate was found.",
    .parameters = kBusDetectParameters,
    .examples = kBusDetectExamples,
    .needs = Needs::nothing,
    .effect = Effect::links,
    .family = FamilyCheck::never,
    .run = run_bus_detect,
    .check = check_bus_detect,
};

}  // namespace servoctl::commands
