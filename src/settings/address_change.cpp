#include "settings/address_change.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "canopen/node_id.hpp"
#include "canopen/node_list.hpp"
#include "drive/bitrate.hpp"
#include "drive/cia402.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/identify.hpp"
#include "session/open_bus.hpp"
#include "session/scan.hpp"
#include "session/write.hpp"
#include "settings/change.hpp"
#include "settings/own_cob_ids.hpp"
#include "show/planned_messages.hpp"

namespace servoctl::settings {
namespace {

using session::Identity;

tl::unexpected<Error> no_parameter(const show::Desk& desk) {
  if (desk.session->network().is_ring())
    return fail(Errc::usage, "a drive on EtherCAT has no node-ID: it is addressed by its place on the ring",
                "the number after -n changes with the order of the cables");
  return fail(Errc::usage,
              message("no parameter of a {} is known that sets its node-ID", as_it_is(desk.profile->family)),
              "look into its manual: switches, its panel, or the vendor's software; where it is an object, "
              "`address NEW --object INDEX:SUB`");
}

/// The parameter as the drive has it: its length is the drive's, whatever the manual says.
Result<void> add_write(show::Desk& desk, AddressChange& change, const std::string& name, std::int64_t value,
                       bool anyway) {
  const auto target = drive::resolve(desk.profile, name);
  if (!target) return fail(target.error());
  auto present = desk.session->upload(change.node, target->address);
  if (!present) return fail(present.error());
  const auto as_held = drive::fitted(drive::meaning(*target, change.node), present->size());
  const auto learned = learned_meaning(change.node, *target, as_held, *present);
  if (!learned)
    return fail(drive_error(Errc::refused, change.node, target->address,
                            message("has {} bytes: it cannot hold a node-ID or bitrate", present->size())));
  const auto& meaning = *learned;
  if (const auto fits = drive::check_limits(meaning, od::Value(value)); !fits) return fits;
  auto data = od::encode(meaning.type, od::Value(value));
  if (!data) return fail(data.error());
  if (*data == *present && !anyway) return {};
  change.writes.push_back({change.node, target->address, std::move(*data)});
  change.before.push_back(std::move(*present));
  return {};
}

Result<void> hold_serial(const Identity& identity, const AddressWish& wish) {
  if (!wish.serial || identity.serial == wish.serial) return {};
  return fail(drive_error(
      Errc::refused, identity.node, objects::kSerialNumber,
      identity.serial ? message("the drive has the serial number {}, not {}", *identity.serial, *wish.serial)
                      : message("the drive tells no serial number, {} is expected", *wish.serial),
      "nothing was written; `info` shows what it is"));
}

/// A bitrate that was written and waits for the next start would come with the new node-ID.
Result<void> hold_bitrate(show::Desk& desk, const AddressChange& change, const AddressWish& wish) {
  const auto& name = desk.profile->rules.nmt.bitrate;
  if (!change.moves() || wish.bitrate || !wish.bus_bitrate || name.empty()) return {};
  const auto target = drive::resolve(desk.profile, name);
  if (!target) return fail(target.error());
  const auto held = desk.session->upload(change.node, target->address);
  if (!held) return held.error().code == Errc::sdo_abort ? Result<void>() : fail(held.error());
  const auto next = drive::bitrate_of_code(*desk.profile, static_cast<std::int64_t>(load_le(*held)));
  if (!next || *next == *wish.bus_bitrate) return {};
  return fail(drive_error(
      Errc::refused, change.node, target->address,
      message("it starts at {} next, and its bus has {}: to move it is to start anew, and it would be gone",
              drive::bitrate_text(*next), drive::bitrate_text(*wish.bus_bitrate)),
      message(
          "nothing was written; `address --bitrate {} -n {}` takes that back, and all go to the other one "
          "with `address --bitrate {} -n all`",
          as_it_is(*wish.bus_bitrate), node_name(change.node), as_it_is(*next))));
}

void add_restart(const AddressChange& change, report::Table& plan) {
  if (change.idle() || !change.restarts()) return;
  const auto node = change.told_at != 0 ? change.told_at : change.node;
  plan.json_only = false;
  plan.rows.push_back(
      {node, "NMT", drive::name(change.restart), {}, session::restart_frame(node, change.restart)});
}

/// The messages to a drive, where it will be then.
std::vector<session::PlannedMessage> messages_to(const AddressChange& change,
                                                 const session::Rehearsal& rehearsal) {
  auto out = rehearsal.messages();
  if (change.told_at == 0) return out;
  for (auto& message : out) {
    message.node = change.told_at;
    if (message.write) message.write->node = change.told_at;
  }
  return out;
}

Result<void> rehearse(show::Desk& desk, const AddressChange& change, bool unlock,
                      session::Rehearsal& rehearsal) {
  if (change.writes.empty()) return {};
  session::StorageScope storage(*desk.session, desk.profile, change.node);
  storage.rehearse(rehearsal);
  if (const auto opened = storage.open(session::can_store(*desk.profile), unlock, true); !opened)
    return opened;
  for (const auto& write : change.writes) rehearsal.add(session::planned_write(write));
  const auto closed = storage.close(true, change.writes.size());
  return closed ? Result<void>() : fail(closed.error());
}

}  // namespace

Result<AddressChange> plan_address(show::Desk& desk, std::uint8_t node, const AddressWish& wish) {
  const auto& rules = desk.profile->rules.nmt;
  if (desk.session->network().is_ring() || (wish.node && rules.node_id.empty())) return no_parameter(desk);
  if (wish.node && (*wish.node < canopen::kFirstNode || *wish.node > canopen::kLastNode))
    return fail(Errc::usage, message("{} is not a node-ID", *wish.node), "node-IDs are 1 to 127");
  const auto code =
      wish.bitrate ? drive::bitrate_code(*desk.profile, *wish.bitrate) : Result<std::int64_t>(0);
  if (!code) return fail(code.error());
  AddressChange out;
  out.profile = desk.profile;
  out.node = node;
  out.to = wish.node.value_or(node);
  out.restart = rules.address_after;
  auto identity = session::read_identity(*desk.session, node);
  if (!identity) return fail(identity.error());
  out.identity = std::move(*identity);
  if (const auto held = hold_serial(out.identity, wish); !held) return fail(held.error());
  if (const auto single = session::refuse_duplicate(*desk.session, node); !single)
    return fail(single.error());
  if (const auto still = refuse_energised(*desk.session, node, "its address"); !still)
    return fail(still.error());
  if (wish.node)
    if (const auto done = add_write(desk, out, rules.node_id, out.to, out.moves()); !done)
      return fail(done.error());
  if (wish.bitrate) {
    if (const auto done = add_write(desk, out, rules.bitrate, *code, false); !done) return fail(done.error());
    out.bitrate = wish.bitrate;
  }
  if (const auto stays = hold_bitrate(desk, out, wish); !stays) return fail(stays.error());
  auto cob_ids = out.moves() ? read_own_cob_ids(desk, node) : Result<session::Values>(session::Values{});
  if (!cob_ids) return fail(cob_ids.error());
  out.cob_ids = std::move(*cob_ids);
  return out;
}

Result<void> refuse_energised(session::Session& session, std::uint8_t node, std::string_view what) {
  const auto energised = session::is_energised(session, node);
  if (!energised) return fail(energised.error());
  if (!*energised) return {};
  return fail(drive_error(
      Errc::refused, node,
      !session::sharers_of(session, node).empty()
          ? message("two drives have this node-ID, and one is energised: {} cannot be changed now", what)
          : message("it is energised: {} cannot be changed now", what),
      message("`disable -n {}` de-energises it; make sure that the load is held", node_name(node))));
}

Result<void> refuse_energised_nodes(session::Session& session, std::string_view what) {
  const auto found = session::scan(session, canopen::every_node_id());
  if (!found) return fail(found.error());
  for (const auto& identity : *found)
    if (const auto still = refuse_energised(session, identity.node, what); !still) return fail(still.error());
  return {};
}

Result<void> refuse_taken(show::Desk& desk, std::span<const std::uint8_t> nodes, Duration listening) {
  if (nodes.empty()) return {};
  const auto used =
      session::nodes_in_use(*desk.session, nodes, {.listening = listening, .guards = !desk.dry_run});
  if (!used) return fail(used.error());
  if (used->empty()) {
    tell_unguarded(desk);
    return {};
  }
  const auto& [node, how] = *used->begin();
  return fail(drive_error(Errc::refused, node, message("this node-ID is taken: {}", how),
                          "nothing was written; `scan` shows who is there"));
}

void tell_unguarded(show::Desk& desk) {
  if (desk.dry_run || session::guards_nodes(*desk.session)) return;
  auto text = message("{} carries no remote frames: nodes that are stopped (NMT) were not looked for",
                      as_it_is(desk.session->url()));
  if (std::ranges::find(desk.notices, text) == desk.notices.end()) desk.notices.push_back(std::move(text));
}

std::string_view text_of(AddressEnd end) {
  switch (end) {
    case AddressEnd::nothing_to_do: return "nothing to do";
    case AddressEnd::moved: return "moved";
    case AddressEnd::at_bitrate: return "found at its new bitrate";
    case AddressEnd::awaits_restart: return "written; holds from its next start";
    case AddressEnd::as_before: return "not changed";
    case AddressEnd::failed: break;
  }
  return "failed; see the error";
}

Result<report::Value> planned_address(show::Desk& desk, std::span<const AddressChange> changes, bool unlock) {
  report::Value out;
  for (const auto& change : changes) {
    const FamilyScope family(desk, change.profile);
    session::Rehearsal rehearsal;
    if (const auto done = rehearse(desk, change, unlock, rehearsal); !done) return fail(done.error());
    auto part = show::planned_messages(desk, messages_to(change, rehearsal));
    auto* more = part.table();
    if (more != nullptr) add_restart(change, *more);
    auto* table = out.table();
    if (table == nullptr || more == nullptr) {
      out = std::move(part);
      continue;
    }
    table->json_only = table->json_only && more->json_only;
    table->rows.insert(table->rows.end(), more->rows.begin(), more->rows.end());
  }
  return out;
}

std::vector<std::string> bitrate_steps(const std::string& bus_url, std::uint32_t bitrate,
                                       const std::string& family) {
  auto name = session::canonical_url(bus_url);
  const bool is_serial = name.starts_with("slcan:");
  const bool is_kernels = name.find(':') == std::string::npos;
  std::vector<std::string> out;
  if (is_kernels && !family.empty())
    out.push_back(formatted(
        "`address --bitrate {} -n all -d {}` restarts all drives and switches {} with them; by hand:",
        bitrate, family, name));
  out.push_back(
      "change all nodes of the bus before any of them restarts: one with another bitrate disturbs the rest");
  out.push_back("then switch all of them off");
  out.push_back(is_serial    ? formatted("name the bus with its new bitrate: slcan:PORT@{}", bitrate)
                : is_kernels ? formatted("`bus up {} --bitrate {}`", name, bitrate)
                             : formatted("set the bitrate of the bus behind {} to {}", name, bitrate));
  out.push_back("switch them on; `scan` shows who answers");
  return out;
}

}  // namespace servoctl::settings
