#include "settings/address_change.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <utility>

#include "base/duration.hpp"
#include "canopen/node_id.hpp"
#include "drive/bitrate.hpp"
#include "drive/cia402.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/identify.hpp"
#include "session/open_bus.hpp"
#include "session/option_scope.hpp"
#include "session/scan.hpp"
#include "session/write.hpp"
#include "show/planned_messages.hpp"

namespace servoctl::settings {
namespace {

using drive::NmtRules;
using session::Identity;

/// From an NMT reset to the boot-up message.
constexpr Duration kBootPatience = std::chrono::seconds(10);
constexpr Duration kSecondLook = std::chrono::seconds(1);
/// CAN-ID without the node-ID, in a COB-ID (CiA 301, 7.3.5).
constexpr std::uint64_t kNodePart = 0x7F;

tl::unexpected<Error> no_parameter(const show::Desk& desk) {
  if (desk.session->network().is_ring())
    return fail(Errc::usage, "a drive on EtherCAT has no node-ID: it is addressed by its place on the ring",
                "the number after -n changes with the order of the cables");
  return fail(Errc::usage,
              fmt::format("no parameter of a {} is known that sets its node-ID", desk.profile->family),
              "look into its manual: switches, its panel, or the vendor's software");
}

/// The parameter as the drive has it: its length is the drive's, whatever the manual says.
Result<void> add_write(show::Desk& desk, AddressChange& change, const std::string& name, std::int64_t value,
                       bool anyway) {
  const auto target = drive::resolve(desk.profile, name);
  if (!target) return fail(target.error());
  auto present = desk.session->upload(change.node, target->address);
  if (!present) return fail(present.error());
  const auto meaning = drive::fitted(drive::meaning(*target, change.node), present->size());
  if (const auto fits = drive::check_limits(meaning, od::Value(value)); !fits) return fits;
  auto data = od::encode(meaning.type, od::Value(value));
  if (!data) return fail(data.error());
  if (*data == *present && !anyway) return {};
  change.writes.push_back({change.node, target->address, std::move(*data)});
  change.before.push_back(std::move(*present));
  return {};
}

Result<void> refuse_energised(session::Session& session, std::uint8_t node) {
  const auto word = session.upload(node, objects::kStatusword);
  if (!word && word.error().code != Errc::sdo_abort) return fail(word.error());
  if (!word || !drive::is_energised(drive::decode_state(static_cast<std::uint16_t>(load_le(*word)))))
    return {};
  return fail(drive_error(Errc::refused, node, "it is energised: its address cannot be changed now",
                          "`disable` de-energises it; make sure that the load is held"));
}

Result<void> hold_serial(const Identity& identity, const AddressWish& wish) {
  if (!wish.serial || identity.serial == wish.serial) return {};
  return fail(drive_error(
      Errc::refused, identity.node, objects::kSerialNumber,
      identity.serial
          ? fmt::format("the drive has the serial number {}, not {}", *identity.serial, *wish.serial)
          : fmt::format("the drive tells no serial number, {} is expected", *wish.serial),
      "nothing was written; `info` shows what it is"));
}

/// COB-IDs of PDOs and emergencies, as far as the family has them and the drive tells.
Result<session::Values> read_cob_ids(show::Desk& desk, std::uint8_t node) {
  std::vector<session::SdoRequest> requests;
  const auto add = [&](ObjectAddress object) {
    if (desk.profile->dictionary.find(object) != nullptr)
      requests.push_back({.node = node, .object = object});
  };
  add(objects::kEmergencyCobId);
  for (const std::uint16_t first : {std::uint16_t{0x1400}, std::uint16_t{0x1800}})
    for (std::uint16_t pdo = 0; pdo < 8; ++pdo) add({static_cast<std::uint16_t>(first + pdo), 1});
  const auto answers = desk.session->transfer(requests);
  session::Values out;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (answers[i]) out.emplace(requests[i].object, *answers[i]);
    if (!answers[i] && answers[i].error().code != Errc::sdo_abort) return fail(answers[i].error());
  }
  return out;
}

/// Those with the old node-ID in them that did not follow it.
std::vector<ObjectAddress> stayed(const AddressChange& change, const session::Values& now) {
  std::vector<ObjectAddress> out;
  for (const auto& [object, data] : change.cob_ids) {
    const auto found = now.find(object);
    const bool of_node = (load_le(data) & kNodePart) == change.node;
    if (of_node && found != now.end() && found->second == data) out.push_back(object);
  }
  return out;
}

bool is_same_drive(const Identity& one, const Identity& other) {
  return one.device_type == other.device_type && one.vendor_id == other.vendor_id &&
         one.product_code == other.product_code && one.revision == other.revision &&
         one.serial == other.serial && one.device_name == other.device_name;
}

bool tells_itself_apart(const Identity& identity) { return identity.serial.value_or(0) != 0; }

std::string serial_text(const Identity& identity) {
  return identity.serial ? fmt::format("serial number {}", *identity.serial) : "no serial number";
}

/// One drive on its way to its new address.
class AddressRun {
 public:
  AddressRun(show::Desk& desk, const AddressChange& change, const AddressOptions& options)
      : desk_(&desk), session_(desk.session), change_(&change), options_(&options) {}

  AddressOutcome run() {
    if (change_->idle()) {
      out_.end = AddressEnd::nothing_to_do;
      return std::move(out_);
    }
    if (change_->writes.empty() || write()) restart();
    return std::move(out_);
  }

 private:
  bool fail_with(AddressEnd end, Error error) {
    out_.end = end;
    out_.error = std::move(error);
    return false;
  }

  /// What is begun is brought to its end, whoever is impatient.
  bool write() {
    const session::Deaf deaf(*session_);
    session::StorageScope storage(*session_, desk_->profile, change_->node);
    const bool keeps = session::can_store(*desk_->profile);
    if (const auto opened = storage.open(keeps, options_->unlock, true); !opened)
      return fail_with(AddressEnd::as_before, opened.error());
    const auto written = session::write_all(*session_, change_->writes, true);
    const auto wrong = std::find_if(written.begin(), written.end(), [](const auto& w) { return !w; });
    const bool all = wrong == written.end();
    const auto back = all ? Result<void>() : put_back(written);
    const auto done =
        std::count_if(written.begin(), written.end(), [](const auto& w) { return w.has_value(); });
    const auto kept = storage.close(all, static_cast<std::size_t>(done));
    for (const auto& notice : storage.notices()) desk_->notices.push_back(notice);
    if (!all) return not_written(wrong->error(), back);
    if (!kept) return not_kept(kept.error());
    out_.kept = *kept;
    return true;
  }

  /// A write that was refused has changed nothing; any other may have been done.
  Result<void> put_back(std::span<const Result<session::Written>> written) {
    Result<void> out;
    for (std::size_t i = 0; i < written.size(); ++i) {
      if (!written[i] && written[i].error().code == Errc::sdo_abort) continue;
      const session::SdoRequest back[] = {{change_->node, change_->writes[i].object, change_->before[i]}};
      const auto done = session::write_all(*session_, back, true).front();
      if (!done) out = fail(done.error());
    }
    return out;
  }

  bool not_written(Error error, const Result<void>& back) {
    const auto& store = desk_->profile->rules.store;
    if (error.code == Errc::sdo_abort && !store.unlock.empty() && !options_->unlock)
      error.hint = fmt::format("it may be locked by {}: add --unlock", store.unlock);
    if (back) return fail_with(AddressEnd::as_before, std::move(error));
    error.message += "; what it holds now is not known: " + back.error().message;
    error.hint = fmt::format("before it is switched off: `read {} -n {}`, its node-ID for the next start",
                             desk_->profile->rules.nmt.node_id, change_->node);
    return fail_with(AddressEnd::failed, std::move(error));
  }

  /// An address that is written and not kept would come and go with the power.
  bool not_kept(Error error) {
    const std::vector<Result<session::Written>> written(change_->writes.size(), session::Written{});
    const auto back = put_back(written);
    error.message = "the address was written and could not be kept: " + error.message;
    if (back) {
      error.message += "; the old one was written back";
      return fail_with(AddressEnd::as_before, std::move(error));
    }
    error.message += "; and writing the old one back failed: " + back.error().message;
    return fail_with(AddressEnd::failed, std::move(error));
  }

  void restart() {
    if (!change_->moves() && !change_->bitrate && change_->writes.empty()) return;
    out_.end = AddressEnd::awaits_restart;
    if (change_->bitrate || (!change_->restarts() && options_->patience == Duration::zero())) return;
    if (!change_->restarts())
      desk_->tell(fmt::format("switch node {} off and on again now: it is waited for at node {} for {}\n",
                              change_->node, change_->to, to_string(options_->patience)));
    if (const auto sent = session::restart_node(*session_, change_->node, change_->restart); !sent) {
      fail_with(AddressEnd::failed, written_but(sent.error()));
      return;
    }
    if (change_->moves()) session::forget_node(*session_, change_->to);
    const auto patience = change_->restarts() ? kBootPatience : options_->patience;
    const auto came =
        session::wait_for_boot(*session_, change_->node, change_->to, session_->now() + patience);
    if (came)
      find();
    else
      fail_with(AddressEnd::failed, written_but(came.error()));
  }

  Error written_but(Error error) const {
    error.message = fmt::format("node {} was told to be node {}; whether it is one by now is not known: {}",
                                change_->node, change_->to, error.message);
    error.hint = "`scan` shows who answers";
    error.node = change_->node;
    return error;
  }

  Error about(Errc code, std::string what, std::string hint) const {
    return drive_error(code, change_->node, what, std::move(hint));
  }

  /// Who answers at the two nodes. A boot-up that was heard may have been another's, and some answer only a
  /// while behind theirs: where nobody is at the new one, once more.
  Result<std::vector<Identity>> look() {
    const std::uint8_t both[] = {change_->node, change_->to};
    const auto nodes = std::span(both).first(change_->moves() ? 2U : 1U);
    auto found = session::scan(*session_, nodes);
    const auto is_new = [&](const Identity& identity) { return identity.node == change_->to; };
    if (!found || std::any_of(found->begin(), found->end(), is_new)) return found;
    const auto waited = session_->wait([] { return false; }, session_->now() + kSecondLook);
    if (!waited) return fail(waited.error());
    return session::scan(*session_, nodes);
  }

  void find() {
    const auto found = look();
    if (!found) {
      fail_with(AddressEnd::failed, written_but(found.error()));
      return;
    }
    const auto at = [&](std::uint8_t node) {
      return std::find_if(found->begin(), found->end(), [&](const Identity& i) { return i.node == node; });
    };
    const auto here = at(change_->to);
    const bool old = change_->moves() && at(change_->node) != found->end();
    if (here == found->end())
      not_there(old);
    else if (!is_same_drive(*here, change_->identity))
      fail_with(AddressEnd::failed,
                about(Errc::refused,
                      fmt::format("node {} answers now, but is another drive: {}, and {} before", change_->to,
                                  serial_text(*here), serial_text(change_->identity)),
                      "`scan --long` shows who is there"));
    else if (old)
      fail_with(
          AddressEnd::failed,
          about(Errc::negative,
                fmt::format("it answers as node {0} now, and node {1} still answers: two drives had the "
                            "node-ID {1}, or one has two",
                            change_->to, change_->node),
                "`scan --long` shows both"));
    else
      arrived();
  }

  void not_there(bool old) {
    if (!old)
      return void(fail_with(
          AddressEnd::failed,
          about(Errc::timeout, fmt::format("neither node {} nor node {} answers", change_->node, change_->to),
                change_->restarts() ? "switch it off and on, and look with `scan`"
                                    : "is it still off? `scan` shows who answers")));
    const auto& name = desk_->profile->rules.nmt.node_id;
    const auto place = drive::place_of(*desk_->profile, name);
    const auto held = session_->upload(change_->node, *place);
    if (held && load_le(*held) != change_->to)
      return void(fail_with(AddressEnd::failed,
                            about(Errc::negative,
                                  fmt::format("it forgot its new address when it restarted: {} is {} again",
                                              name, load_le(*held)),
                                  "does it keep its values? `store` may be refused, or its flash be worn")));
    out_.end = AddressEnd::awaits_restart;
    const std::string_view why = change_->restarts() ? "the NMT command did not put its new address in force"
                                                     : "it was not switched off and on";
    out_.error = about(Errc::negative, fmt::format("still answers at its old address: {}", why),
                       fmt::format("switch it off and on; then it is node {}", change_->to));
  }

  void arrived() {
    out_.end = AddressEnd::moved;
    if (!change_->moves()) return;
    if (!tells_itself_apart(change_->identity))
      desk_->notices.push_back(fmt::format(
          "node {}: it tells no serial number of its own: that it is the drive that was node {} is "
          "known by its kind alone",
          change_->to, change_->node));
    const auto now = read_cob_ids(*desk_, change_->to);
    if (!now) {
      out_.error = now.error();
      return;
    }
    out_.stayed = stayed(*change_, *now);
    tell_stayed(*now);
  }

  void tell_stayed(const session::Values& now) {
    if (out_.stayed.empty()) return;
    std::vector<std::string> each;
    for (const auto object : out_.stayed)
      each.push_back(fmt::format("{} = 0x{:08X}", to_string(object), load_le(now.at(object))));
    desk_->notices.push_back(fmt::format(
        "node {}: COB-IDs that did not follow, and still are those of node {}: {}; where that is not "
        "meant, `pdo show` and `write` put them right",
        change_->to, change_->node, fmt::join(each, ", ")));
  }

  show::Desk* desk_;
  session::Session* session_;
  const AddressChange* change_;
  const AddressOptions* options_;
  AddressOutcome out_;
};

void add_restart(const AddressChange& change, report::Value& plan) {
  auto* table = std::get_if<report::Table>(&plan.data());
  if (table == nullptr || !change.restarts()) return;
  table->json_only = false;
  table->rows.push_back({change.node,
                         "NMT",
                         drive::name(change.restart),
                         {},
                         session::restart_frame(change.node, change.restart)});
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
    return fail(Errc::usage, fmt::format("{} is not a node-ID", *wish.node), "node-IDs are 1 to 127");
  const auto code =
      wish.bitrate ? drive::bitrate_code(*desk.profile, *wish.bitrate) : Result<std::int64_t>(0);
  if (!code) return fail(code.error());
  AddressChange out;
  out.node = node;
  out.to = wish.node.value_or(node);
  out.restart = rules.address_after;
  auto identity = session::read_identity(*desk.session, node);
  if (!identity) return fail(identity.error());
  out.identity = std::move(*identity);
  if (const auto held = hold_serial(out.identity, wish); !held) return fail(held.error());
  if (const auto single = session::refuse_duplicate(*desk.session, node); !single)
    return fail(single.error());
  if (const auto still = refuse_energised(*desk.session, node); !still) return fail(still.error());
  if (wish.node)
    if (const auto done = add_write(desk, out, rules.node_id, out.to, out.moves()); !done)
      return fail(done.error());
  if (wish.bitrate) {
    const auto before = out.writes.size();
    if (const auto done = add_write(desk, out, rules.bitrate, *code, false); !done) return fail(done.error());
    if (out.writes.size() > before) out.bitrate = wish.bitrate;
  }
  auto cob_ids = out.moves() ? read_cob_ids(desk, node) : Result<session::Values>(session::Values{});
  if (!cob_ids) return fail(cob_ids.error());
  out.cob_ids = std::move(*cob_ids);
  return out;
}

Result<void> refuse_taken(session::Session& session, std::span<const std::uint8_t> nodes,
                          Duration listening) {
  if (nodes.empty()) return {};
  const auto used = session::nodes_in_use(session, nodes, listening);
  if (!used) return fail(used.error());
  if (used->empty()) return {};
  const auto& [node, how] = *used->begin();
  return fail(drive_error(Errc::refused, node, fmt::format("this node-ID is taken: it {}", how),
                          "nothing was written; `scan` shows who is there"));
}

std::string_view text_of(AddressEnd end) {
  switch (end) {
    case AddressEnd::nothing_to_do: return "nothing to do";
    case AddressEnd::moved: return "moved";
    case AddressEnd::awaits_restart: return "written; holds from its next start";
    case AddressEnd::as_before: return "not changed";
    case AddressEnd::failed: break;
  }
  return "failed; see the error";
}

AddressOutcome change_address(show::Desk& desk, const AddressChange& change, const AddressOptions& options) {
  return AddressRun(desk, change, options).run();
}

Result<report::Value> planned_address(show::Desk& desk, std::span<const AddressChange> changes, bool unlock) {
  session::Rehearsal rehearsal;
  for (const auto& change : changes)
    if (const auto done = rehearse(desk, change, unlock, rehearsal); !done) return fail(done.error());
  auto out = show::planned_messages(desk, rehearsal.messages());
  for (const auto& change : changes) add_restart(change, out);
  return out;
}

std::vector<std::string> bitrate_steps(const std::string& bus_url, std::uint32_t bitrate) {
  auto name = session::canonical_url(bus_url);
  if (name.find(':') != std::string::npos) name = "can0";
  return {
      "change all nodes of the bus before any of them restarts: one with another bitrate disturbs the rest",
      "then switch all of them off",
      fmt::format("`sudo ip link set {} down`, `sudo ip link set {} up type can bitrate {}`", name, name,
                  bitrate),
      "switch them on; `scan` shows who answers"};
}

}  // namespace servoctl::settings
