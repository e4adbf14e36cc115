#include <fmt/format.h>
#include <algorithm>

#include "base/duration.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "command/duration_option.hpp"
#include "command/lss_options.hpp"
#include "command/setting_options.hpp"
#include "drive/bitrate.hpp"
#include "session/lss.hpp"
#include "session/open_bus.hpp"
#include "settings/address_change.hpp"
#include "settings/lss_node.hpp"

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

/// What a line asks for.
struct BitrateWish {
  std::uint8_t index = 0;
  std::optional<std::uint32_t> bitrate;  ///< Empty: it is to find it itself.
  std::optional<std::uint16_t> delay_ms;
  bool all = false;
  bool keep = false;

  std::string rate_text() const {
    return bitrate ? drive::bitrate_text(*bitrate) : std::string("automatic detection");
  }
};

Result<BitrateWish> bitrate_wish(const Context& context, const Arguments& arguments) {
  BitrateWish out;
  out.all = arguments.has("--all");
  out.keep = arguments.has("--keep");
  if (lower(arguments.text("rate")) == "auto") {
    out.index = canopen::kLssAutomaticBitrate;
  } else {
    const auto bitrate = drive::parse_bitrate(arguments.text("rate"));
    if (!bitrate) return fail(bitrate.error());
    const auto index = canopen::lss_bit_timing(*bitrate);
    if (!index)
      return fail(Errc::usage, fmt::format("LSS has no {}", drive::bitrate_text(*bitrate)),
                  "1M, 800k, 500k, 250k, 125k, 50k, 20k, 10k (CiA 305, table 0), or auto");
    out.index = *index;
    out.bitrate = bitrate.value();
  }
  const auto delay = duration_option(arguments, "--activate");
  if (!delay) return fail(delay.error());
  if (*delay) {
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(**delay).count();
    if (ms < 1 || **delay > kLongestDelay)
      return fail(Errc::usage, fmt::format("--activate {} is not possible", to_string(**delay)),
                  "1ms to 65s: long enough to change the interface as well");
    out.delay_ms = static_cast<std::uint16_t>(ms);
  }
  if (!out.all) {
    if (const auto good = check_lss_choice(context, arguments); !good) return fail(good.error());
    return out;
  }
  for (const auto name : {"--vendor", "--product", "--revision", "--serial", "--only"})
    if (arguments.has(name))
      return fail(Errc::usage, fmt::format("--all and {} contradict each other", name));
  return out;
}

std::vector<canopen::LssRequest> requests_of(const BitrateWish& wish) {
  std::vector<canopen::LssRequest> out;
  if (wish.all) out.push_back(canopen::lss_inquire(canopen::LssService::inquire_node));
  out.push_back(canopen::lss_set_bit_timing(wish.index));
  if (wish.keep) out.push_back(canopen::lss_store());
  if (wish.delay_ms) out.push_back(canopen::lss_activate_bit_timing(*wish.delay_ms));
  return out;
}

std::string question_lss_set_bitrate(const BitrateWish& wish) {
  auto out = fmt::format("Set {} in {}?", wish.rate_text(),
                         wish.all ? "every LSS slave on the bus" : "one LSS slave");
  if (wish.delay_ms)
    out += fmt::format(
        " It is in force after {} ms, twice that without a message: an axis in motion loses its master.",
        *wish.delay_ms);
  if (wish.delay_ms && !wish.all) out += " Whoever on the bus keeps another bitrate disturbs the rest.";
  return out;
}

/// What holds after one of several slaves did not do as the others.
std::string not_activated(const canopen::LssRequest& request, std::string_view more) {
  const bool stores = request.answer == canopen::LssService::store;
  return fmt::format(
      "nothing was activated{}; {}",
      stores ? ", but slaves that confirmed have stored it, and take it when they are switched on" : "",
      more);
}

/// All who confirm; one that refuses is an error, and so is one of the `expected` that is silent.
Result<std::size_t> order_all(session::LssDialogue& lss, const canopen::LssRequest& request,
                              std::size_t expected, Duration patience) {
  const auto answers = lss.ask(request, patience);
  if (!answers) return fail(answers.error());
  if (answers->empty() && expected == 0)
    return fail(Errc::timeout, "no LSS slave answers on this bus", "many drives have no LSS");
  const bool asks = request.answer == canopen::LssService::inquire_node;
  const auto refused = std::find_if(answers->begin(), answers->end(),
                                    [&](const auto& answer) { return !asks && answer.error != 0; });
  if (refused != answers->end())
    return fail(
        Errc::negative,
        fmt::format("an LSS slave of {} refuses: {}", answers->size(), canopen::lss_error_text(*refused)),
        not_activated(request, "`lss inquire` shows what each slave is"));
  if (answers->size() < expected)
    return fail(Errc::negative,
                fmt::format("of {} LSS slaves {} confirmed what was set", expected, answers->size()),
                not_activated(request, "one that does not support a request may leave it unanswered"));
  return answers->size();
}

Result<std::size_t> change_bitrate(session::LssDialogue& lss, const BitrateWish& wish, Duration patience) {
  const auto slow = std::max(patience, settings::kLssStorePatience);
  std::size_t slaves = wish.all ? 0 : 1;
  for (const auto& request : requests_of(wish)) {
    const bool stores = request.answer == canopen::LssService::store;
    if (!request.answer) {
      const auto sent = lss.ask(request);
      if (!sent) return fail(sent.error());
    } else if (wish.all) {
      const auto done = order_all(lss, request, slaves, stores ? slow : patience);
      if (!done) return fail(done.error());
      slaves = *done;
    } else if (const auto done = lss.order(request, stores ? "stored its configuration" : "set its bitrate",
                                           stores ? slow : patience);
               !done) {
      return fail(done.error());
    }
  }
  return slaves;
}

/// What holds now, and what somebody has to do.
void tell_bitrate(Context& context, const BitrateWish& wish) {
  const auto url = session::canonical_url(context.session->url());
  const bool has_bitrate = url.find(':') == std::string::npos || url.starts_with("socketcan:");
  if (!wish.delay_ms)
    context.notices.push_back(
        wish.keep
            ? "it holds when the slave is switched off and on: change all nodes of the bus before that"
            : "it is not in force: --activate DELAY puts it in force, --keep stores it for the next start");
  if (url.starts_with("slcan:")) {
    if (wish.bitrate)
      context.notices.push_back(fmt::format(
          "{} the bus has to be named with that bitrate: slcan:PORT@{}; then `lss inquire` or `scan`",
          wish.delay_ms ? "now" : "then", *wish.bitrate));
    return;
  }
  if (!has_bitrate) {
    context.notices.push_back(fmt::format(
        "{} has no bitrate: slaves that are simulated take it, and nothing follows", context.session->url()));
    return;
  }
  if (!wish.bitrate) return;
  const auto name = url.substr(url.find(':') == std::string::npos ? 0 : url.find(':') + 1);
  context.notices.push_back(fmt::format(
      "{} the interface has to change as well: `bus up {} --bitrate {}`; then `lss inquire` or `scan`",
      wish.delay_ms ? "now" : "then", name, *wish.bitrate));
}

Result<Value> run_lss_set_bitrate(Context& context, const Arguments& arguments) {
  const auto wish = bitrate_wish(context, arguments);
  if (!wish) return fail(wish.error());
  const auto choice = wish->all ? Result<LssChoice>(LssChoice{}) : lss_choice(context, arguments);
  if (!choice) return fail(choice.error());
  if (context.dry_run) return lss_planned_frames(*choice, requests_of(*wish));
  if (wish->delay_ms)
    if (const auto still = settings::refuse_energised_nodes(*context.session, "the bitrate of its bus");
        !still)
      return fail(still.error());
  if (const auto sure = context.confirm(question_lss_set_bitrate(*wish)); !sure) return fail(sure.error());
  const auto patience = context.session->options().timeout;
  session::LssDialogue lss(*context.session, patience);
  report::Record out;
  if (wish->all) {
    const auto reset = lss.ask(canopen::lss_switch_all(canopen::LssState::waiting));
    if (!reset) return fail(reset.error());
    if (const auto sent = lss.select_all(); !sent) return fail(sent.error());
    for (const auto* key : {"vendor_id", "product_code", "revision", "serial"})
      out.push_back({key, {}, report::Show::json});
  } else {
    const auto slave = lss.select(choice->address);
    if (!slave) return fail(slave.error());
    out = lss_identity_record(slave->address);
  }
  const auto slaves = change_bitrate(lss, *wish, patience);
  if (!slaves) return fail(slaves.error());
  // Still at the old bitrate: what was activated waits for the delay first.
  if (const auto left = lss.leave(); !left) context.errors.push_back(left.error());
  out.push_back({"slaves", *slaves});
  out.push_back({"bitrate", wish->bitrate ? Value(*wish->bitrate) : Value()});
  out.push_back({"kept", wish->keep});
  out.push_back({"active_after_ms", wish->delay_ms ? Value(*wish->delay_ms) : Value()});
  tell_bitrate(context, *wish);
  return Value(std::move(out));
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
        "is energised. The interface is not changed by this; how is told. A node that keeps its bitrate on "
        "a bus with another one disturbs everybody, so change all of them or none.",
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
