#include "command/lss_options.hpp"

#include <array>

#include "base/format.hpp"
#include "base/number.hpp"
#include "session/can_network.hpp"
#include "session/identify.hpp"
#include "session/lss.hpp"

namespace servoctl::command {
namespace {

using canopen::LssAddress;
using report::Hex;
using report::Value;

constexpr std::string_view kIdentity[] = {"--vendor", "--product", "--revision", "--serial"};

std::size_t numbers_given(const Arguments& arguments) {
  std::size_t out = 0;
  for (const auto name : kIdentity) out += arguments.has(name) ? 1U : 0U;
  return out;
}

/// What `lss select` chose; null where nothing is, and for lines that are run later.
const LssAddress* selected(const Context& context) {
  auto* can = context.session == nullptr ? nullptr : context.session->can();
  return can != nullptr && can->lss_selection() ? &*can->lss_selection() : nullptr;
}

bool names_node(const Context& context) { return context.nodes.size() == 1 && context.nodes.front() != 0; }

/// What a node says of itself; one that keeps back a part cannot be selected by it, nor one of two.
Result<LssAddress> address_of_node(Context& context, std::uint8_t node) {
  const auto identity = session::read_identity(*context.session, node);
  if (!identity) return fail(identity.error());
  const std::uint8_t here[] = {node};
  if (const auto heard = session::settle_duplicates(*context.session, here, session::kBeforeMotion); !heard)
    return fail(heard.error());
  if (auto single = session::refuse_duplicate(*context.session, node); !single) {
    single.error().hint =
        "name the one that is meant by --vendor, --product, --revision and --serial: `lss scan --vendor V "
        "--product P` shows the LSS slaves of a kind";
    return fail(std::move(single.error()));
  }
  const auto& i = *identity;
  if (i.vendor_id && i.product_code && i.revision && i.serial)
    return LssAddress{*i.vendor_id, *i.product_code, *i.revision, *i.serial};
  return fail(
      drive_error(Errc::negative, node, "it does not tell its whole identity (1018h:01 to 1018h:04)",
                  "--only where it is the only LSS slave, or --vendor, --product, --revision and --serial "
                  "by its label"));
}

}  // namespace

Result<std::optional<std::uint32_t>> lss_number(const Arguments& arguments, std::string_view name) {
  if (!arguments.has(name)) return std::optional<std::uint32_t>();
  const auto number = parse_integer(arguments.text(name));
  const auto value = number ? number->as_unsigned() : std::nullopt;
  if (!value || *value > 0xFFFF'FFFFU)
    return fail(Errc::usage,
                message("{}: '{}' is not a number of 32 bits", name, as_it_is(arguments.text(name))),
                "write 1234 or 0x4D2; `scan --long` and `lss scan` show such numbers");
  return std::optional(static_cast<std::uint32_t>(*value));
}

Result<void> check_lss_choice(const Context& context, const Arguments& arguments) {
  const auto given = numbers_given(arguments);
  for (const auto name : kIdentity)
    if (const auto number = lss_number(arguments, name); !number) return fail(number.error());
  if (given != 0 && given != std::size(kIdentity))
    return fail(Errc::usage, "LSS selects a slave by its whole identity",
                "all of --vendor, --product, --revision and --serial; `lss scan` shows them");
  const int ways = (given != 0 ? 1 : 0) + (arguments.has("--only") ? 1 : 0) + (context.nodes_typed ? 1 : 0);
  if (ways > 1)
    return fail(Errc::usage, "the slave is named twice",
                "--vendor to --serial, or --only, or -n: one of them");
  if (ways == 0 && selected(context) != nullptr) return {};
  if (ways == 0 && context.nodes.empty())
    return fail(Errc::usage, "which LSS slave?",
                "--vendor, --product, --revision and --serial; -n 3 for a node that answers; --only; or lss "
                "select before, at the prompt");
  if (given == 0 && !arguments.has("--only") && !names_node(context))
    return fail(Errc::usage, "one LSS slave at a time", "-n 3, or its identity");
  return {};
}

Result<LssChoice> lss_choice(Context& context, const Arguments& arguments) {
  if (const auto good = check_lss_choice(context, arguments); !good) return fail(good.error());
  if (arguments.has("--only")) return LssChoice{};
  const auto* chosen = numbers_given(arguments) == 0 && !context.nodes_typed ? selected(context) : nullptr;
  if (chosen != nullptr) {
    context.notices.push_back(
        message("the LSS slave that was selected: vendor 0x{:08X}, product 0x{:08X}, "
                "revision 0x{:08X}, serial {}",
                chosen->vendor, chosen->product, chosen->revision, chosen->serial));
    return LssChoice{*chosen};
  }
  if (numbers_given(arguments) == 0) {
    const auto address = address_of_node(context, context.nodes.front());
    if (!address) return fail(address.error());
    return LssChoice{*address};
  }
  std::array<std::uint32_t, 4> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = **lss_number(arguments, kIdentity[i]);
  return LssChoice{LssAddress{numbers[0], numbers[1], numbers[2], numbers[3]}};
}

report::Record lss_identity_record(const LssAddress& address) {
  return {{"vendor_id", Hex{address.vendor, 8}, report::Show::everywhere, "vendor"},
          {"product_code", Hex{address.product, 8}, report::Show::everywhere, "product"},
          {"revision", Hex{address.revision, 8}},
          {"serial", address.serial}};
}

Result<Value> look_at_lss_slave(Context& context, const LssChoice& choice,
                                const std::function<void(const LssAddress&)>& found) {
  if (context.dry_run) {
    using canopen::LssService;
    std::vector<canopen::LssRequest> requests;
    for (const auto what : {LssService::inquire_node, LssService::inquire_vendor, LssService::inquire_product,
                            LssService::inquire_revision, LssService::inquire_serial})
      requests.push_back(canopen::lss_inquire(what));
    return lss_planned_frames(choice, requests);
  }
  session::LssDialogue lss(*context.session, context.session->options().timeout);
  const auto slave = lss.select(choice.address);
  if (!slave) return fail(slave.error());
  if (const auto left = lss.leave(); !left) context.errors.push_back(left.error());
  if (found) found(slave->address);
  auto out = lss_identity_record(slave->address);
  const bool has_node = slave->node && !slave->is_unconfigured();
  out.push_back({"node", has_node ? Value(*slave->node) : Value()});
  out.push_back({"configured", slave->node ? Value(has_node) : Value()});
  return Value(std::move(out));
}

Value lss_planned_frames(const LssChoice& choice, std::span<const canopen::LssRequest> requests) {
  report::Table table;
  table.columns = {{"frame"}};
  const auto add = [&](const canopen::LssRequest& request) {
    for (const auto& frame : request.frames) table.rows.push_back({can::to_string(frame)});
  };
  add(canopen::lss_switch_all(canopen::LssState::waiting));
  add(choice.address ? canopen::lss_select(*choice.address)
                     : canopen::lss_switch_all(canopen::LssState::configuration));
  for (const auto& request : requests) add(request);
  add(canopen::lss_switch_all(canopen::LssState::waiting));
  return Value(std::move(table));
}

}  // namespace servoctl::command
