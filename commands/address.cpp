#include <algorithm>
#include <filesystem>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/node_id.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "command/family_at.hpp"
#include "command/interface_option.hpp"
#include "command/setting_options.hpp"
#include "drive/bitrate.hpp"
#include "session/open_bus.hpp"
#include "session/scan.hpp"
#include "settings/address_object.hpp"
#include "settings/address_plan_run.hpp"
#include "settings/address_table.hpp"
#include "settings/bitrate_switch.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;
using settings::AddressChange;
using settings::AddressEnd;
using settings::AddressOutcome;

constexpr std::uintmax_t kMostBytesOfPlan = 1U << 20U;

constexpr Parameter kAddressParameters[] = {
    {.name = "new", .help = "the new node-ID, 1 to 127", .kind = Kind::number},
    {.name = "--bitrate", .help = "the new bitrate: 125k, 250k, 500k, 1M", .kind = Kind::text},
    {.name = "--plan",
     .help = "renumber several: a CSV file with node,new (family,serial,bitrate)",
     .kind = Kind::file},
    {.name = "--wait",
     .help = "how long to wait for a drive that is to be switched off and on",
     .kind = Kind::duration},
    kUnlockOption,
    {.name = "--object",
     .help = "200C:2: the object of the node-ID, if the data of the family name none",
     .kind = Kind::object},
    {.name = "--resume", .help = "resume an interrupted plan", .kind = Kind::flag},
};

Result<settings::AddressWish> address_wish(const Arguments& arguments) {
  settings::AddressWish out;
  if (arguments.has("new")) {
    const auto number = parse_integer(arguments.text("new"));
    const auto node = number ? number->as_unsigned() : std::nullopt;
    if (!node || *node < canopen::kFirstNode || *node > canopen::kLastNode)
      return fail(Errc::usage, message("'{}' is not a node-ID", as_it_is(arguments.text("new"))),
                  "node-IDs are 1 to 127");
    out.node = static_cast<std::uint8_t>(*node);
  }
  if (arguments.has("--bitrate")) {
    const auto bitrate = drive::parse_bitrate(arguments.text("--bitrate"));
    if (!bitrate) return fail(bitrate.error());
    out.bitrate = *bitrate;
  }
  return out;
}

Result<settings::AddressOptions> address_options(const Arguments& arguments) {
  const auto patience = duration_option(arguments, "--wait");
  if (!patience) return fail(patience.error());
  return settings::AddressOptions{.unlock = arguments.has("--unlock"),
                                  .patience = patience->value_or(Duration::zero())};
}

/// What goes together in the line, told before anything is asked.
Result<void> check_words(const Context& context, const Arguments& arguments) {
  if (arguments.has("--plan")) {
    if (arguments.has("new") || arguments.has("--bitrate"))
      return fail(Errc::usage, "--plan names all addresses itself", "leave the node-ID and --bitrate out");
    if (arguments.has("--object"))
      return fail(Errc::usage, "--object is for one drive, not for --plan",
                  "`address NEW --object OBJECT -n NODE` for each");
    return {};
  }
  if (arguments.has("--resume")) return fail(Errc::usage, "--resume resumes a plan", "add --plan FILE.csv");
  if (!arguments.has("new") && !arguments.has("--bitrate"))
    return fail(Errc::usage, "there is nothing to change", "`address 5`, or --bitrate 500k, or --plan FILE");
  if (arguments.has("--object") && !arguments.has("new"))
    return fail(Errc::usage, "--object names the object of the node-ID, and no new node-ID is given",
                "`address 5 --object 200C:2`; `write` writes a bitrate by its code");
  if (context.nodes.empty())
    return fail(Errc::usage, "'address' needs a node",
                message("add -n {}; `scan` shows who is there", node_name(1)));
  if (arguments.has("new") && (context.nodes.size() != 1 || context.nodes.front() == 0))
    return fail(Errc::usage, "one drive gets a new node-ID at a time",
                message("-n {}, or several with --plan FILE.csv", node_name(1)));
  return {};
}

/// The axis that the cabinet file has at the node to which another one goes; null: none, or there is no such
/// file.
const cabinet::Axis* axis_at(const Context& context, const AddressChange& change) {
  if (!change.moves()) return nullptr;
  for (const auto* axis : context.axes) {
    if (axis->node != change.node) continue;
    const auto cabinet = context.front_end->cabinet();
    return cabinet ? (*cabinet)->at(axis->bus, change.to) : nullptr;
  }
  return nullptr;
}

std::string change_text(const AddressChange& change) {
  const auto serial = change.identity.serial.value_or(0);
  const auto who = serial != 0 ? formatted("node {} (serial number {})", change.node, serial)
                               : formatted("node {}", change.node);
  if (!change.bitrate) return formatted("{} to node-ID {}", who, change.to);
  const auto rate = drive::bitrate_text(*change.bitrate);
  if (!change.moves()) return formatted("{} to the bitrate {}", who, rate);
  return formatted("{} to node-ID {} and the bitrate {}", who, change.to, rate);
}

std::string question_address(const Context& context, std::span<const AddressChange> changes,
                             const settings::BitrateSwitch& follower) {
  std::string out;
  for (const auto& change : changes)
    if (!change.idle()) append(out, change_text(change));
  for (const auto& change : changes)
    if (const auto* other = axis_at(context, change); other != nullptr)
      out += formatted("; in the cabinet file {} is the place of axis {}", change.to, other->name);
  if (follower.follows()) {
    out = out.empty() ? "Every drive has it for its next start" : formatted("Re-address {}", out);
    out += "; " + settings::switch_text(follower);
    if (const auto who = who_receives(follower.link->name()); !who.empty()) out += "; " + who;
    return out + ".";
  }
  if (std::ranges::none_of(changes, &AddressChange::restarts))
    return formatted("Re-address {}? It holds when the drive is switched off and on.", out);
  return context.profile->rules.nmt.address_after == drive::NmtRules::Restart::reset_node
             ? formatted("Re-address {}? It is restarted (NMT reset node).", out)
             : formatted("Re-address {}? It is restarted (NMT reset communication).", out);
}

/// What a file of the user's says of the drive that has moved.
void tell_axes(Context& context, const AddressChange& change, const AddressOutcome& outcome) {
  if (outcome.end != AddressEnd::moved && outcome.end != AddressEnd::awaits_restart) return;
  if (change.moves()) tell_moved_axis(context, change.node, change.to, change.identity.serial);
}

/// Nobody waited for it.
void tell_power(Context& context, const AddressChange& change, const AddressOutcome& outcome) {
  if (outcome.end != AddressEnd::awaits_restart || outcome.error || change.bitrate) return;
  context.notices.push_back(
      message("node {}: switch it off and on; then it is node {} (`--wait 5min` waits for it, `info -n {}` "
              "shows it)",
              node_name(change.node), change.to, change.to));
}

/// How the interface follows its drives to another bitrate, where one is wished.
Result<settings::BitrateSwitch> follower_of(Context& context, std::span<const AddressChange> changes,
                                            std::optional<std::uint32_t> bitrate,
                                            const settings::AddressOptions& options) {
  if (!bitrate) return settings::BitrateSwitch{};
  const auto name = session::canonical_url(context.session->url());
  auto link = name.find(':') == std::string::npos ? can::open_link(name) : nullptr;
  auto out = settings::plan_switch(context, link ? std::move(*link) : nullptr, changes, *bitrate, options);
  if (!out || !out->follows()) return out;
  if (const auto held = hold_energised(context, name); !held) return fail(held.error());
  return out;
}

Result<Value> change_addresses(Context& context, std::span<const AddressChange> changes,
                               const settings::AddressOptions& options, settings::BitrateSwitch& follower) {
  std::vector<AddressOutcome> outcomes;
  for (const auto& change : changes) outcomes.push_back(settings::change_address(context, change, options));
  const bool all = std::ranges::all_of(outcomes, [](const AddressOutcome& outcome) {
    return !outcome.error &&
           (outcome.end == AddressEnd::awaits_restart || outcome.end == AddressEnd::nothing_to_do);
  });
  if (follower.follows() && all)
    settings::follow_bitrate(context, follower, changes, outcomes, options);
  else if (follower.follows())
    context.notices.push_back(
        message("{} stays at its bitrate, and nothing is restarted: not every drive was written",
                as_it_is(follower.link->name())));
  bool awaits_bitrate = false;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (outcomes[i].error) context.errors.push_back(*outcomes[i].error);
    tell_power(context, changes[i], outcomes[i]);
    tell_axes(context, changes[i], outcomes[i]);
    awaits_bitrate = awaits_bitrate || (outcomes[i].end == AddressEnd::awaits_restart && changes[i].bitrate);
  }
  if (awaits_bitrate) settings::tell_bitrate_by_hand(context, follower, changes);
  return Value(settings::address_table(changes, outcomes));
}

Result<Value> run_plan(Context& context, const Arguments& arguments,
                       const settings::AddressOptions& options) {
  const std::filesystem::path file(arguments.text("--plan"));
  const auto text = read_file(file, kMostBytesOfPlan);
  if (!text) return fail(text.error());
  settings::AddressPlanOptions all{.each = options, .resume = arguments.has("--resume")};
  all.bus_bitrate = session::bitrate_of(context.session->url());
  all.family_of = [&](const settings::AddressRow& row) { return family_at(context, row.family, row.node); };
  all.hold = [&](std::uint8_t node, const drive::Profile& family) {
    return context.hold_family(std::vector{node}, &family, true);
  };
  all.follower = [&](std::span<const AddressChange> changes, std::uint32_t bitrate) {
    return follower_of(context, changes, bitrate, options);
  };
  all.beside = [](const settings::BitrateSwitch& follower) { return who_receives(follower.link->name()); };
  all.moved = [&](const settings::AddressRow& row, std::optional<std::uint32_t> serial) {
    tell_moved_axis(context, row.node, row.to, serial);
  };
  return settings::run_address_plan(context, *text, file, all);
}

/// `all` are those that answer.
Result<void> name_all(Context& context) {
  if (context.nodes.front() != 0) return {};
  auto nodes = session::nodes_present(*context.session);
  if (!nodes) return fail(nodes.error());
  context.nodes = std::move(*nodes);
  return context.hold_family(context.nodes, context.profile, true);
}

Result<Value> run_change(Context& context, const Arguments& arguments,
                         const settings::AddressOptions& options) {
  auto wish = address_wish(arguments);
  if (!wish) return fail(wish.error());
  if (wish->node && !wish->bitrate) wish->bus_bitrate = session::bitrate_of(context.session->url());
  if (const auto named = name_all(context); !named) return fail(named.error());
  std::vector<AddressChange> changes;
  for (const auto node : context.nodes) {
    auto change = settings::plan_address(context, node, *wish);
    if (!change) return fail(change.error());
    if (change->moves()) context.free_nodes.push_back(change->to);
    changes.push_back(std::move(*change));
  }
  if (const auto free = settings::refuse_taken(context, context.free_nodes); !free) return fail(free.error());
  auto follower = follower_of(context, changes, wish->bitrate, options);
  if (!follower) return fail(follower.error());
  if (context.dry_run) {
    if (follower->follows()) context.notices.push_back("then " + settings::switch_commands(*follower));
    return settings::planned_address(context, changes, options.unlock);
  }
  const bool idle = std::ranges::all_of(changes, &AddressChange::idle) && !follower->follows();
  auto agreed = idle ? Result<void>() : context.confirm(question_address(context, changes, *follower));
  // One may have been enabled meanwhile.
  for (auto change = changes.begin(); agreed && change != changes.end(); ++change)
    agreed = settings::refuse_energised(*context.session, change->node, "its address");
  if (!agreed) return fail(agreed.error());
  return change_addresses(context, changes, options, *follower);
}

Result<Value> run_address(Context& context, const Arguments& arguments) {
  const auto options = address_options(arguments);
  if (!options) return fail(options.error());
  if (const auto words = check_words(context, arguments); !words) return fail(words.error());
  if (arguments.has("--plan")) return run_plan(context, arguments, *options);
  if (!arguments.has("--object")) return run_change(context, arguments, *options);
  if (const auto wish = address_wish(arguments); !wish) return fail(wish.error());
  const auto own = settings::with_address_object(*context.profile, arguments.text("--object"));
  if (!own) return fail(own.error());
  if (const auto right = settings::check_address_object(context, *own); !right) return fail(right.error());
  const settings::FamilyScope scope(context, &*own);
  return run_change(context, arguments, *options);
}

Result<void> check_address(Context& context, const Arguments& arguments) {
  if (const auto words = check_words(context, arguments); !words) return words;
  if (arguments.has("--object"))
    if (const auto own = settings::with_address_object(*context.profile, arguments.text("--object")); !own)
      return fail(own.error());
  const auto wish = address_wish(arguments);
  return wish ? Result<void>() : fail(wish.error());
}

constexpr Example kAddressExamples[] = {
    {"address 5 -n 1 -d gsd600", "node 1 becomes node 5"},
    {"address --bitrate 500k -n all -d gsd600", "every drive of the bus, and its interface"},
    {"address --plan nodes.csv -d gsd600", "renumber several by a table with the columns node,new"},
};

}  // namespace

extern const Command kAddress;
const Command kAddress{
    .path = "address",
    .summary = "Give a drive another node-ID or bitrate; asks first",
    .details =
        "Writes the family's own parameter, reads it back, stores it by the family's way and restarts the "
        "drive (NMT), or says that it is to be switched off and on: `drives FAMILY` shows which. Then the "
        "drive is looked for at its new node-ID, and held against what it said of itself before. A node-ID "
        "that somebody uses is refused: all that answer, are heard within 1.5 s, or answer node guarding, which starts life guarding where 100Ch and 100Dh are set. An energised "
        "drive is left alone. COB-IDs that did not follow the node-ID are listed. Masters, and nodes that watch the "
        "heartbeat of the drive, are not told of its new number.\n\n"
        "With --bitrate, all nodes of the bus are named (-n all) and change together: all are written first, then "
        "restarted by one NMT command, the interface is taken to the new bitrate, and each drive is looked for; "
        "where none took it, the interface goes back. Drives that have to be switched off and on need --wait: the "
        "interface changes when all are off. It is left alone, and what to do by hand is listed, where it has no "
        "bitrate that can be set (an slcan adapter is named with its new one), where the right CAP_NET_ADMIN is "
        "missing, or where somebody on the bus would be left behind. --dry-run shows the commands.\n\n"
        "For a drive whose data name no parameter of the node-ID (-d FILE.eds, cia402), --object names the object "
        "that holds it. It is refused if it does not hold the present node-ID, and stored by 1010h.\n\n"
        "--plan FILE.csv renumbers several (columns node,new; family, serial and "
        "bitrate where wanted; without a family it is that of -d, else that of the axis in the cabinet file): all are looked at first, and each moves when its new node-ID is free; "
        "drives that exchange theirs go through a free one. When all have their bitrate, the interface goes "
        "with them as with --bitrate. It ends with the first that fails; "
        "FILE.csv.journal keeps how far it came, and --resume continues.",
    .parameters = kAddressParameters,
    .examples = kAddressExamples,
    .needs = Needs::dictionary | Needs::can,
    .effect = Effect::resets,
    .families_in = "--plan",
    .run = run_address,
    .check = check_address,
    .elsewhere = "a drive on EtherCAT is addressed by its place on the ring; it has no node-ID to change",
};

}  // namespace servoctl::commands
