#include <fmt/format.h>
#include <algorithm>

#include "base/signal_wait.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "command/interface_option.hpp"
#include "drive/bitrate.hpp"
#include "session/bitrate_search.hpp"
#include "session/bus_setup.hpp"

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

Result<session::SearchOptions> search_options(const Arguments& arguments) {
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
  auto out = fmt::format("Take {} down to listen at other bitrates? It is up{}{}", name,
                         how.empty() ? "" : " at ", how);
  if (const auto who = who_receives(name); !who.empty()) out += "; " + who;
  return out + ". It is put back afterwards.";
}

/// What the silence, or the noise, means.
Error no_bitrate_found(const std::string& name, const session::Search& search) {
  const bool noise = std::any_of(search.heard.begin(), search.heard.end(),
                                 [](const Heard& heard) { return heard.verdict == Heard::Verdict::errors; });
  if (noise)
    return make_error(
        Errc::negative,
        fmt::format("no bitrate was found on {}: errors were heard, and no frame at any bitrate", name),
        "somebody talks: check CAN_H and CAN_L for being crossed, the 120 ohm at both ends, and that "
        "all nodes have one bitrate; another one than the usual ones: --bitrate 83333");
  return make_error(
      Errc::negative, fmt::format("no bitrate was found on {}: nobody talks", name),
      fmt::format(
          "drives that send nothing by themselves cannot be heard: switch one off and on while this runs (its "
          "boot-up is a frame), listen longer (--for 10s), or ask at each bitrate with `scan --all-bitrates "
          "--bus {}`; then check power, cable and plug",
          name));
}

/// Where it stands if the process is killed in between.
void tell_before(const Context& context, const std::string& name, const can::LinkState& before) {
  const auto how = session::settings_text(before);
  context.tell(fmt::format("{} was {}{}{}; it is put back to that\n", name, before.up ? "up" : "down",
                           how.empty() ? "" : " with ", how));
}

Result<Value> run_bus_detect(Context& context, const Arguments& arguments) {
  const auto name = interface_argument(arguments);
  if (!name) return fail(name.error());
  auto options = search_options(arguments);
  if (!options) return fail(options.error());
  const auto link = can::open_link(*name);
  if (!link) return fail(link.error());
  const auto before = (*link)->state();
  if (!before) return fail(before.error());
  if (context.dry_run) {
    session::Search plan;
    for (const auto bitrate : options->bitrates) plan.heard.push_back({.bitrate = bitrate});
    auto table = bitrates_table(plan);
    table.columns.resize(2);
    for (auto& row : table.rows) row.resize(2);
    return Value(std::move(table));
  }
  if (before->up) {
    if (const auto held = hold_energised(context, *name); !held) return fail(held.error());
    if (const auto agreed = context.confirm(question_bus_detect(*name, *before)); !agreed)
      return fail(agreed.error());
  }
  tell_before(context, *name, *before);
  const auto search = session::search_bitrate(**link, *options);
  if (!search) return fail(search.error());
  if (!search->bitrate) context.errors.push_back(no_bitrate_found(*name, *search));
  report::Record out{
      {"interface", *name},
      {"bitrate", search->bitrate ? Value(*search->bitrate) : Value(), Show::json},
      {"bitrate_text", search->bitrate ? Value(drive::bitrate_text(*search->bitrate)) : Value("not found"),
       Show::text, "bitrate"},
      {"heard", bitrates_table(*search)}};
  if (search->bitrate && (!before->up || before->bitrate != search->bitrate))
    context.notices.push_back(
        fmt::format("{} was put back to what it was; `bus up {} --bitrate {}` takes part in the bus", *name,
                    *name, *search->bitrate));
  return Value(std::move(out));
}

Result<void> check_bus_detect(Context&, const Arguments& arguments) {
  if (const auto name = interface_argument(arguments); !name) return fail(name.error());
  const auto options = search_options(arguments);
  return options ? Result<void>() : fail(options.error());
}

constexpr Example kBusDetectExamples[] = {
    {"bus detect can0", "listen at one bitrate after the other; nothing is sent"},
    {"bus detect can0 --bitrate 500k --bitrate 1M --for 5s",
     "at these two, five seconds each, where drives seldom speak"},
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
