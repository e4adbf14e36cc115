
#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "command/duration_option.hpp"
#include "command/interface_option.hpp"
#include "command/lss_options.hpp"
#include "command/setting_options.hpp"
#include "drive/bitrate.hpp"
#include "session/open_bus.hpp"
#include "settings/address_change.hpp"
#include "settings/lss_bitrate.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kLssSetBitrateParameters[] = {
    {.name = "rate",
     .help = "1M, 800k, 500k, 250k, 125k, 50k, 20k, 10k, or auto",
     .kind = Kind::text,
     .required = true},
    {.name = "--activate", .help = "all change after this time, such as 2s", .kind = Kind::duration},
    {.name = "--all", .help = "every LSS slave on the bus", .kind = Kind::flag},
    kVendorOption,
    kProductOption,
    kRevisionOption,
    kSerialOption,
    kOnlySlaveOption,
    kKeepOption,
};

constexpr Duration kLongestDelay = std::chrono::milliseconds(0xFFFF);

using settings::BitrateSwitch;
using settings::LssBitrateChange;

std::string rate_text(const LssBitrateChange& change) {
  return change.bitrate ? drive::bitrate_text(*change.bitrate) : std::string("automatic detection");
}

Result<LssBitrateChange> bitrate_wish(const Context& context, const Arguments& arguments) {
  LssBitrateChange out;
  out.all = arguments.has("--all");
  out.keep = arguments.has("--keep");
  if (lower(arguments.text("rate")) == "auto") {
    out.index = canopen::kLssAutomaticBitrate;
  } else {
    const auto bitrate = drive::parse_bitrate(arguments.text("rate"));
    if (!bitrate) return fail(bitrate.error());
    const auto index = canopen::lss_bit_timing(*bitrate);
    if (!index)
      return fail(Errc::usage, message("LSS has no {}", drive::bitrate_text(*bitrate)),
                  "1M, 800k, 500k, 250k, 125k, 50k, 20k, 10k (CiA 305, table 0), or auto");
    out.index = *index;
    out.bitrate = bitrate.value();
  }
  const auto delay = duration_option(arguments, "--activate");
  if (!delay) return fail(delay.error());
  if (*delay) {
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(**delay).count();
    if (ms < 1 || **delay > kLongestDelay)
      return fail(Errc::usage, message("--activate {} is not possible", to_string(**delay)),
                  "1ms to 65s: long enough to change the interface as well");
    out.delay_ms = static_cast<std::uint16_t>(ms);
  }
  if (!out.all) {
    if (const auto good = check_lss_choice(context, arguments); !good) return fail(good.error());
    return out;
  }
  for (const auto name : {"--vendor", "--product", "--revision", "--serial", "--only"})
    if (arguments.has(name)) return fail(Errc::usage, message("--all and {} contradict each other", name));
  return out;
}

std::string question_lss_set_bitrate(const LssBitrateChange& change, const BitrateSwitch& follower) {
  auto out = formatted("Set {} in {}?", rate_text(change),
                       change.all ? "every LSS slave on the bus" : "one LSS slave");
  if (change.delay_ms)
    out += formatted(
        " It is in force after {} ms, twice that without a message: an axis in motion loses its master.",
        *change.delay_ms);
  if (follower.follows()) {
    out += " " + settings::lss_switch_text(follower);
    if (const auto who = who_receives(follower.link->name()); !who.empty()) out += "; " + who;
    return out + ".";
  }
  if (change.delay_ms && !change.all) out += " Whoever on the bus keeps another bitrate disturbs the rest.";
  return out;
}

/// What holds now, and what somebody has to do.
void tell_bitrate(Context& context, const LssBitrateChange& wish, const BitrateSwitch& follower) {
  if (follower.follows()) return;
  if (follower.link != nullptr)
    context.notices.push_back(
        message("{} is left alone: {}", as_it_is(follower.link->name()), follower.why_not));
  const auto url = session::canonical_url(context.session->url());
  if (!wish.delay_ms)
    context.notices.push_back(
        wish.keep
            ? "it holds when the slave is switched off and on: change all nodes of the bus before that"
            : "it is not in force: --activate DELAY puts it in force, --keep stores it for the next start");
  if (url.starts_with("slcan:")) {
    if (wish.bitrate)
      context.notices.push_back(
          message("{} the bus has to be named with that bitrate: slcan:PORT@{}; then `lss inquire` or `scan`",
                  wish.delay_ms ? "now" : "then", *wish.bitrate));
    return;
  }
  if (const auto link = session::link_of(url); !link || link->kind != "can") {
    context.notices.push_back(
        message("{} has no bitrate: slaves that are simulated take it, and nothing follows",
                as_it_is(context.session->url())));
    return;
  }
  if (!wish.bitrate || (follower.link && follower.before.bitrate == wish.bitrate)) return;
  context.notices.push_back(message(
      "{} the interface has to change as well: `bus up {} --bitrate {}`; then `lss inquire` or `scan`",
      wish.delay_ms ? "now" : "then", as_it_is(url), *wish.bitrate));
}

/// How the interface goes with the slaves, where they change now.
Result<BitrateSwitch> lss_follower(Context& context, const LssBitrateChange& change) {
  const auto name = session::canonical_url(context.session->url());
  auto link = name.find(':') == std::string::npos ? can::open_link(name) : nullptr;
  auto out = settings::plan_lss_switch(link ? std::move(*link) : nullptr, change);
  if (!out || !out->follows()) return out;
  if (const auto held = hold_energised(context, name); !held) return fail(held.error());
  return out;
}

report::Record lss_bitrate_record(const LssBitrateChange& change,
                                  const settings::LssBitrateOutcome& outcome) {
  report::Record out;
  if (outcome.address)
    out = lss_identity_record(*outcome.address);
  else
    for (const auto* key : {"vendor_id", "product_code", "revision", "serial"})
      out.push_back({key, {}, report::Show::json});
  out.push_back({"slaves", outcome.slaves});
  out.push_back({"bitrate", change.bitrate ? Value(*change.bitrate) : Value()});
  out.push_back({"kept", change.keep});
  out.push_back({"active_after_ms", change.delay_ms ? Value(*change.delay_ms) : Value(),
                 report::Show::everywhere, "active after (ms)"});
  return out;
}

Result<Value> planned_lss_set_bitrate(Context& context, const LssBitrateChange& change,
                                      const BitrateSwitch& follower) {
  if (follower.follows())
    context.notices.push_back(message("then {}, unless somebody would be left behind: nobody was asked",
                                      settings::lss_switch_commands(follower)));
  return lss_planned_frames({change.address}, settings::lss_bitrate_requests(change));
}

Result<Value> run_lss_set_bitrate(Context& context, const Arguments& arguments) {
  auto change = bitrate_wish(context, arguments);
  if (!change) return fail(change.error());
  if (!change->all) {
    const auto choice = lss_choice(context, arguments);
    if (!choice) return fail(choice.error());
    change->address = choice->address;
  }
  auto follower = lss_follower(context, *change);
  if (!follower) return fail(follower.error());
  if (context.dry_run) return planned_lss_set_bitrate(context, *change, *follower);
  if (change->delay_ms)
    if (const auto still = settings::refuse_energised_nodes(*context.session, "the bitrate of its bus");
        !still)
      return fail(still.error());
  if (const auto asked = settings::leave_nobody_behind(*context.session, *change, *follower); !asked)
    return fail(asked.error());
  if (const auto sure = context.confirm(question_lss_set_bitrate(*change, *follower)); !sure)
    return fail(sure.error());
  const auto outcome = settings::set_lss_bitrate(context, *change, *follower);
  if (!outcome) return fail(outcome.error());
  if (outcome->error) context.errors.push_back(*outcome->error);
  tell_bitrate(context, *change, *follower);
  return Value(lss_bitrate_record(*change, *outcome));
}

Result<void> check_lss_set_bitrate(Context& context, const Arguments& arguments) {
  const auto wish = bitrate_wish(context, arguments);
  return wish ? Result<void>() : fail(wish.error());
}

constexpr Example kLssSetBitrateExamples[] = {
    {"lss set-bitrate 500k --only --keep", "one slave, in force when it starts again"},
    {"lss set-bitrate 500k --all --keep --activate 5s", "all slaves of the bus, in force five seconds later"},
};

}  // namespace

extern const Command kLssSetBitrate;
const Command kLssSetBitrate{
    .path = "lss set-bitrate",
    .summary = "Set the bitrate of LSS slaves; asks first",
    .details =
        "The bitrates are those of CiA 305, table 0. The slave is named as for `lss inquire`; --all sets "
        "it in every slave that answers, and tells how many did: count them. It is in force when the slave "
        "starts again, if --keep stored it, or with --activate: then the slaves say nothing for the delay, "
        "change, say nothing for as long again, and go on: refused while a drive that answers on the bus "
        "is energised. An interface of the kernel goes with them between the two silences, and the slaves are "
        "looked for; where none answers and some do at the old bitrate, it goes back. It is left alone, and "
        "what to do by hand is told, where it has no bitrate that can be set, where the right CAP_NET_ADMIN "
        "is missing, where somebody on the bus would be left behind, and without --activate. A node that "
        "keeps its bitrate on a bus with another one disturbs everybody, so change all of them or none.",
    .parameters = kLssSetBitrateParameters,
    .examples = kLssSetBitrateExamples,
    .needs = Needs::can,
    .effect = Effect::resets,
    .family = FamilyCheck::never,
    .run = run_lss_set_bitrate,
    .check = check_lss_set_bitrate,
    .elsewhere = "EtherCAT has one bitrate",
};

}  // namespace servoctl::commands
