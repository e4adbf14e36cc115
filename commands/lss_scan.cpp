#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "canopen/node_id.hpp"
#include "command/duration_option.hpp"
#include "command/lss_options.hpp"
#include "command/setting_options.hpp"
#include "session/scan.hpp"
#include "settings/address_change.hpp"
#include "settings/lss_node.hpp"
#include "show/identity.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using canopen::LssAddress;
using report::Value;

/// Slaves answer within some milliseconds; where nobody does, each bit costs this.
constexpr Duration kDefaultPatience = std::chrono::milliseconds(50);

constexpr Parameter kLssScanParameters[] = {
    {.name = "--assign",
     .help = "give them node-IDs in turn, from this one on; asks first",
     .kind = Kind::number},
    kKeepOption,
    {.name = "--patience", .help = "longest wait for one answer (default 50ms)", .kind = Kind::duration},
    kVendorOption,
    kProductOption,
    kRevisionOption,
    kSerialOption,
};

/// What a line asks for.
struct ScanWish {
  std::optional<std::uint8_t> first;  ///< Of the node-IDs to be given.
  Duration patience = kDefaultPatience;
  std::optional<LssAddress> low, high;  ///< Looked for by identity, not by fastscan.
};

Result<void> read_range(const Arguments& arguments, ScanWish& wish) {
  std::optional<std::uint32_t> numbers[4];
  constexpr std::string_view names[] = {"--vendor", "--product", "--revision", "--serial"};
  for (std::size_t i = 0; i < 4; ++i) {
    auto number = lss_number(arguments, names[i]);
    if (!number) return fail(number.error());
    numbers[i] = *number;
  }
  const auto& [vendor, product, revision, serial] = numbers;
  if (!vendor && !product && !revision && !serial) return {};
  if (!vendor || !product)
    return fail(Errc::usage, "a scan by identity needs --vendor and --product",
                "without them fastscan finds every slave that has no node-ID");
  wish.low = LssAddress{*vendor, *product, revision.value_or(0), serial.value_or(0)};
  wish.high = LssAddress{*vendor, *product, revision.value_or(0xFFFF'FFFF), serial.value_or(0xFFFF'FFFF)};
  return {};
}

Result<ScanWish> scan_wish(const Arguments& arguments) {
  ScanWish out;
  const auto patience = duration_option(arguments, "--patience");
  if (!patience) return fail(patience.error());
  out.patience = patience->value_or(kDefaultPatience);
  if (const auto range = read_range(arguments, out); !range) return fail(range.error());
  if (!arguments.has("--assign")) {
    if (arguments.has("--keep"))
      return fail(Errc::usage, "--keep keeps what --assign gives", "add --assign 5, or see `lss store`");
    return out;
  }
  if (out.low)
    return fail(Errc::usage, "--assign gives node-IDs to slaves that have none",
                "leave --vendor to --serial out, or give one slave its node-ID by `lss set-node`");
  const auto number = parse_integer(arguments.text("--assign"));
  const auto node = number ? number->as_unsigned() : std::nullopt;
  if (!node || *node < canopen::kFirstNode || *node > canopen::kLastNode)
    return fail(Errc::usage, message("'{}' is not a node-ID", as_it_is(arguments.text("--assign"))),
                "node-IDs are 1 to 127");
  out.first = static_cast<std::uint8_t>(*node);
  return out;
}

std::string progress_text(const session::LssProgress& at) {
  return at.again
             ? formatted(
                   "answers came late, asked again: LSS slaves found: {}; of the next identity {} of {} bits are known",
                   at.found, at.known, at.bits)
             : formatted("LSS slaves found: {}; of the next identity {} of {} bits are known", at.found,
                         at.known, at.bits);
}

Result<std::vector<session::LssFound>> find(Context& context, const ScanWish& wish) {
  session::LssDialogue lss(*context.session, wish.patience);
  lss.on_progress([&](const session::LssProgress& at) { context.show_progress(progress_text(at)); });
  std::vector<session::LssFound> out;
  if (wish.low) {
    const auto found = lss.search(*wish.low, *wish.high);
    if (!found) return fail(found.error());
    for (const auto& address : *found) out.push_back({address, 1, {}});
  } else {
    auto found = lss.scan();
    if (!found) return fail(found.error());
    out = std::move(*found);
  }
  if (const auto left = lss.leave(); !left) context.errors.push_back(left.error());
  return out;
}

void tell_found(Context& context, const ScanWish& wish, std::span<const session::LssFound> found) {
  for (const auto& each : found)
    if (each.slaves > 1)
      context.errors.push_back(make_error(
          Errc::refused, message("{} LSS slaves have one identity: {}", each.slaves, to_string(each.address)),
          "LSS cannot tell them apart: switch all but one of them off, and take one after the other"));
  if (!found.empty() || wish.first) return;
  context.notices.push_back(
      wish.low
          ? "no LSS slave of this identity answers"
          : "no LSS slave without a node-ID answers; `scan` finds nodes that have one, `lss scan --vendor V "
            "--product P` LSS slaves that have one");
}

/// What became of one: its node-ID, and how it ended.
struct Given {
  std::optional<std::uint8_t> node;
  settings::LssNodeOutcome outcome = {};
};

report::Table slaves_table(const Context& context, std::span<const session::LssFound> found,
                           std::span<const Given> given) {
  report::Table table;
  table.columns = {{"vendor_id", "vendor"},
                   {"product_code", "product"},
                   {"revision"},
                   {"serial"},
                   {"slaves", "", report::Show::json},
                   {"family"},
                   {"node"},
                   {"new_node", "new"},
                   {"result"},
                   {"kept"}};
  const auto families = drive::find_families(context.drive_folders);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& a = found[i].address;
    session::Identity identity;
    identity.vendor_id = a.vendor;
    identity.product_code = a.product;
    const auto guess =
        a.vendor == 0 ? std::string() : show::guess_text(session::guess_by_sii(identity, families));
    const auto end = i < given.size() ? given[i] : Given{};
    table.rows.push_back({report::Hex{a.vendor, 8}, report::Hex{a.product, 8}, report::Hex{a.revision, 8},
                          a.serial, found[i].slaves, report::text_or_null(guess),
                          found[i].node ? Value(*found[i].node) : Value(),
                          end.node ? Value(*end.node) : Value(), report::text_or_null(end.outcome.result),
                          end.outcome.kept ? Value(*end.outcome.kept) : Value()});
  }
  table.json_only = found.empty();
  return table;
}

std::string question_lss_scan(std::span<const session::LssFound> found, std::span<const std::uint8_t> nodes) {
  std::string out =
      found.size() == 1 ? "Give this LSS slave its node-ID?" : "Give these LSS slaves their node-IDs?";
  for (std::size_t i = 0; i < found.size(); ++i)
    out += formatted("{} node {}: {}", i == 0 ? "" : ";", nodes[i], to_string(found[i].address));
  return out + ". Each starts with it at once.";
}

Value planned_lss_scan(std::span<const session::LssFound> found, std::span<const std::uint8_t> nodes,
                       bool keep) {
  report::Table table;
  table.columns = {{"new_node", "new"}, {"frame"}};
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::vector<canopen::LssRequest> requests{canopen::lss_set_node(nodes[i])};
    if (keep) requests.push_back(canopen::lss_store());
    const auto frames = lss_planned_frames({found[i].address}, requests);
    for (const auto& row : frames.table()->rows) table.rows.push_back({nodes[i], row.front()});
  }
  return Value(std::move(table));
}

Result<std::vector<std::uint8_t>> nodes_from(std::uint8_t first, std::size_t count) {
  std::vector<std::uint8_t> out;
  for (std::size_t i = 0; i < count; ++i) {
    if (first + i > canopen::kLastNode)
      return fail(Errc::usage, message("{} slaves from node-ID {} on go beyond 127", count, first),
                  "begin lower");
    out.push_back(static_cast<std::uint8_t>(first + i));
  }
  return out;
}

/// One after the other; ends with the first that does not take its node-ID, or takes another, for what went
/// wrong may concern all, and with Ctrl-C. One that has taken it and does not start with it keeps nobody from
/// going on.
std::vector<Given> give(Context& context, std::span<const session::LssFound> found,
                        std::span<const std::uint8_t> nodes, bool keep) {
  std::vector<Given> out;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const session::LssSlave slave{found[i].address, canopen::kUnconfigured};
    context.show_progress(
        formatted("node-ID {} is given: LSS slave {} of {}", nodes[i], i + 1, found.size()));
    out.push_back({nodes[i], settings::give_lss_node(context, slave, {slave.address, nodes[i], keep})});
    const auto& outcome = out.back().outcome;
    if (outcome.error) context.errors.push_back(*outcome.error);
    const bool interrupted = outcome.error && outcome.error->code == Errc::interrupted;
    if (!outcome.taken || outcome.strayed || interrupted) break;
  }
  const auto reached = out.size();
  out.resize(found.size());
  for (auto i = reached; i < out.size(); ++i) out[i].outcome.result = "not reached";
  return out;
}

/// Those that have a node-ID stand last, and keep it.
Result<Value> assign(Context& context, const ScanWish& wish, std::vector<session::LssFound> found,
                     bool keep) {
  const auto configured = std::stable_partition(found.begin(), found.end(),
                                                [](const session::LssFound& each) { return !each.node; });
  const std::span<const session::LssFound> all = found;
  const auto todo = all.first(static_cast<std::size_t>(configured - found.begin()));
  for (const auto& each : all.subspan(todo.size()))
    context.notices.push_back(
        message("node {} answers fastscan, but has a node-ID: it was left alone", node_name(*each.node)));
  const auto nodes = nodes_from(*wish.first, todo.size());
  if (!nodes) return fail(nodes.error());
  if (context.errors.empty() && todo.empty())
    context.errors.push_back(make_error(Errc::negative,
                                        "no node-ID was given: no LSS slave without one answers",
                                        "`lss scan --vendor V --product P` finds LSS slaves that have one"));
  if (!context.errors.empty()) return Value(slaves_table(context, all, {}));
  if (const auto free = settings::refuse_taken(context, *nodes); !free) return fail(free.error());
  if (context.dry_run) return planned_lss_scan(todo, *nodes, keep);
  if (const auto sure = context.confirm(question_lss_scan(todo, *nodes)); !sure) return fail(sure.error());
  const auto given = give(context, todo, *nodes, keep);
  if (!keep)
    context.notices.push_back(
        "not stored: after power-off they have no node-ID again; `lss store` or --keep keeps it");
  return Value(slaves_table(context, all, given));
}

Result<Value> run_lss_scan(Context& context, const Arguments& arguments) {
  const auto wish = scan_wish(arguments);
  if (!wish) return fail(wish.error());
  const auto found = find(context, *wish);
  if (!found) return fail(found.error());
  tell_found(context, *wish, *found);
  if (wish->first) return assign(context, *wish, *found, arguments.has("--keep"));
  return Value(slaves_table(context, *found, {}));
}

Result<void> check_lss_scan(Context&, const Arguments& arguments) {
  const auto wish = scan_wish(arguments);
  return wish ? Result<void>() : fail(wish.error());
}

constexpr Example kLssScanExamples[] = {
    {"lss scan", "who has no node-ID yet; nothing is changed"},
    {"lss scan --assign 5 --keep", "give those 5, 6, 7 …, after a question, and store them"},
    {"lss scan --vendor 0x445653 --product 1", "slaves of this kind, with a node-ID or without"},
};

}  // namespace

extern const Command kLssScan;
const Command kLssScan{
    .path = "lss scan",
    .summary = "Find LSS slaves without a node-ID; --assign gives them one",
    .details =
        "Drives that know LSS (CiA 305) may come without a node-ID: they answer no `scan`. Fastscan finds "
        "them, whatever their identity, in some seconds each: it asks for each bit, and that nobody "
        "answers costs --patience. Nothing is changed; at the end all are back in the waiting state. With "
        "--vendor and --product it looks for slaves of that kind instead, with a node-ID or without (and "
        "--revision, --serial). --assign 5 gives those that were found the node-IDs 5, 6, 7 …, in the "
        "order of their identity, after a question that names each: none of these may be in use. --keep "
        "stores them. Two slaves of one identity are told; then, as after any other error of the search, no "
        "slave gets a node-ID.",
    .parameters = kLssScanParameters,
    .examples = kLssScanExamples,
    .needs = Needs::can,
    .effect = Effect::resets,
    .family = FamilyCheck::never,
    .reads_without = "--assign",
    .run = run_lss_scan,
    .check = check_lss_scan,
    .elsewhere = "a drive on EtherCAT is addressed by its place on the ring: `scan` shows what each is",
};

}  // namespace servoctl::commands
