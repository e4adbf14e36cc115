#include "settings/restore_target.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/format.hpp"
#include "drive/cia402.hpp"
#include "drive/drive_settings.hpp"
#include "drive/standard_objects.hpp"
#include "session/pdo_change.hpp"
#include "session/pdo_cob_ids.hpp"
#include "session/pdo_setup.hpp"
#include "settings/change.hpp"
#include "settings/comparison.hpp"
#include "settings/energising.hpp"
#include "settings/kept_address.hpp"
#include "show/identity.hpp"
#include "show/pdo_check.hpp"

namespace servoctl::settings {
namespace {

using canopen::Pdo;

/// As `pdo map` and its kin would take it: `all` are the PDOs of the drive as they will be.
Result<void> check_pdo(const drive::Profile& profile, const Pdo& present, const Pdo& wanted,
                       std::span<const Pdo> all) {
  if (present.entries != wanted.entries)
    if (const auto maps = show::check_mapping(profile, wanted); !maps) return maps;
  return show::check_communication(profile, present, wanted, all);
}

}  // namespace

Result<void> RestoreTarget::prepare() {
  for (const auto step :
       {&RestoreTarget::check_identity, &RestoreTarget::choose_values, &RestoreTarget::read_present})
    if (const auto done = (this->*step)(); !done) return done;
  if (const auto still = check_standstill(); !still) return still;
  if (const auto fit = check_values(); !fit) return fit;
  if (!choice_.with_address) keeps_address_ = tell_kept_address(*desk_, *backup_, title_, node_);
  if (const auto fit = check_pdos(); !fit) return fit;
  asked_ = wanted_;
  return session::add_pdo_cob_ids(*desk_->session, *desk_->profile, node_, choice_.before, present_, wanted_);
}

Result<void> RestoreTarget::check_identity() {
  const bool force = choice_.force;
  if (backup_->family != desk_->profile->family && !force)
    return fail(Errc::refused,
                formatted("{} is for {}, not for {}", title_, backup_->family, desk_->profile->family),
                "--force restores what fits anyway");
  const std::uint8_t nodes[] = {node_};
  const auto found = session::scan(*desk_->session, nodes);
  if (!found) return fail(found.error());
  if (found->empty())
    return fail(Errc::timeout, formatted("node {} does not answer", node_), "`scan` shows who does");
  identity_ = found->front();
  const auto& drive = identity_;
  if (const auto what = show::other_kind(backup_->identity, drive); !what.empty() && !force)
    return fail(Errc::refused, formatted("node {} is not the drive of {}: {} differs", node_, title_, what),
                "--force restores what fits anyway");
  const bool says_firmware = backup_->identity.revision || !backup_->identity.software_version.empty();
  if (says_firmware && !drive.by_registers &&
      (backup_->identity.revision != drive.revision ||
       backup_->identity.software_version != drive.software_version))
    desk_->notices.push_back(
        formatted("node {}: its firmware differs from the backup's: check the important values", node_));
  return {};
}

/// Gains and limits are no things to change under a drive that holds a load.
Result<void> RestoreTarget::check_standstill() const {
  if (choice_.only_looks) return {};
  if (desk_->session->modbus() != nullptr) return check_at_rest();
  const auto word = desk_->session->upload(node_, objects::kStatusword);
  if (!word && word.error().code != Errc::sdo_abort) return fail(word.error());
  if (!word || !drive::is_energised(drive::decode_state(static_cast<std::uint16_t>(load_le(*word)))))
    return {};
  return fail(Errc::refused, formatted("node {} is energised: its settings cannot be changed now", node_),
              "`disable` de-energises it; make sure that the load is held");
}

/// Where no statusword tells: what the family names instead. An input that enables it tells nothing there.
Result<void> RestoreTarget::check_at_rest() const {
  for (const auto& name : desk_->profile->rules.modbus.at_rest) {
    const auto place = drive::place_of(*desk_->profile, name);
    if (!place) continue;
    const auto value = desk_->session->upload(node_, *place);
    if (!value) return fail(value.error());
    if (load_le(*value) == 0) continue;
    return fail(drive_error(Errc::refused, node_, *place,
                            formatted("{} is not 0: it may be enabled, or its motor turns; its settings "
                                      "cannot be changed now",
                                      name),
                            "stop and disable it first; make sure that the load is held"));
  }
  return {};
}

/// Only what this drive's own data calls a setting is ever written, whatever the file says.
Result<void> RestoreTarget::leave_out(const Backup::Entry& entry, std::string_view reason) {
  const auto what = formatted("{}:{}: {} is not a setting of this drive: {}", title_, entry.line,
                              to_string(entry.object), reason);
  if (!choice_.force) return fail(Errc::refused, what, "nothing was written; --force restores the rest");
  desk_->notices.push_back(what + "; it is left out");
  return {};
}

/// Whether it stays as it is because of how the drive is reached; what is told of that is noted.
bool RestoreTarget::is_out_of_reach(const Backup::Entry& entry) {
  if (!entry.bytes || desk_->session->modbus() == nullptr) return false;
  const bool reached = desk_->profile->rules.modbus.register_of(entry.object).has_value();
  unreachable_ += reached ? 0U : 1U;
  if (!reached || !is_target(*desk_->profile, entry.object)) return !reached;
  desk_->notices.push_back(
      formatted("node {}: {} stays as it is: a drive that an input enables would follow it at once", node_,
                drive::target_at(desk_->profile, entry.object).in_sentence()));
  return true;
}

/// Two drives on one line must not have one address, whichever way they were told.
bool RestoreTarget::is_own_address(ObjectAddress object) const {
  const bool elsewhere = desk_->session->modbus() != nullptr || backup_->identity.node != node_;
  return is_address(desk_->profile, object) || (elsewhere && is_line_address(*desk_->profile, object));
}

Result<void> RestoreTarget::check_line_address(const Backup::Entry& entry) const {
  const auto place = drive::place_of(*desk_->profile, desk_->profile->rules.modbus.node_id);
  if (desk_->session->modbus() == nullptr || place != entry.object || load_le(*entry.bytes) != 0) return {};
  return fail(drive_error(Errc::refused, node_, entry.object,
                          "the backup has the address 0, with which it would answer nobody on Modbus",
                          "nothing was written; leave --with-address out"));
}

Result<void> RestoreTarget::choose_values() {
  std::map<ObjectAddress, std::string_view> settings;
  std::set<ObjectAddress> undecided;
  for (const auto& setting : drive::settings_of(*desk_->profile)) {
    settings.emplace(setting.entry->address, setting.left_out);
    if (!setting.is_writable) undecided.insert(setting.entry->address);
  }
  for (const auto& entry : backup_->entries) {
    const bool is_undecided = entry.bytes && undecided.count(entry.object) > 0;
    undecided_ += is_undecided ? 1U : 0U;
    if (is_undecided || is_out_of_reach(entry)) continue;
    const bool address = is_own_address(entry.object);
    if (!entry.bytes || (address && !choice_.with_address)) continue;
    if (const auto answers = check_line_address(entry); !answers) return answers;
    const auto setting = settings.find(entry.object);
    const auto reason =
        setting == settings.end() ? std::string_view("not in its data, or read-only") : setting->second;
    if (reason.empty())
      wanted_.emplace(entry.object, address ? *entry.bytes
                                            : for_node(desk_->profile, entry.object, *entry.bytes,
                                                       backup_->identity.node, node_));
    else if (const auto left_out = leave_out(entry, reason); !left_out)
      return left_out;
  }
  if (choice_.keep) add_copies(settings);
  tell_kept();
  return {};
}

void RestoreTarget::tell_kept() const {
  if (unreachable_ > 0)
    desk_->notices.push_back(
        formatted("node {}: {} values of {} have no Modbus register and stay as they are", node_,
                  unreachable_, title_));
  if (undecided_ > 0)
    desk_->notices.push_back(formatted(
        "node {}: {} values of {} stay as they are: `eds learn` could not see whether they can be written; where "
        "the manual says so, change AccessType to rw in {}",
        node_, undecided_, title_, desk_->profile->data_sheet.string()));
}

/// What the drive takes from its parameters at its start has to stand there too, unless the file says what
/// does.
void RestoreTarget::add_copies(const std::map<ObjectAddress, std::string_view>& settings) {
  auto all = wanted_;
  session::add_stored_copies(*desk_->profile, node_, all);
  for (auto& [object, value] : all) {
    const auto setting = settings.find(object);
    const bool reached =
        desk_->session->modbus() == nullptr || desk_->profile->rules.modbus.register_of(object);
    const auto* parameter = desk_->profile->parameter(object);
    if (setting == settings.end() || !setting->second.empty() || !reached || parameter == nullptr) continue;
    if (wanted_.emplace(object, std::move(value)).second) copies_.emplace(object, *parameter->mirror);
  }
}

/// A text and a domain are as long as what is written.
bool RestoreTarget::same_length(ObjectAddress object, const Bytes& data) const {
  const auto target = drive::target_at(desk_->profile, object);
  const bool fixed = target.entry == nullptr || od::size_of(target.entry->type);
  return !fixed || data.size() == wanted_.at(object).size();
}

Result<void> RestoreTarget::read_present() {
  std::vector<ObjectAddress> objects;
  for (const auto& value : wanted_) objects.push_back(value.first);
  const auto read = session::read_objects(*desk_->session, node_, objects);
  if (!read) return fail(read.error());
  for (const auto& entry : *read) {
    if (entry.bytes && same_length(entry.object, *entry.bytes)) {
      present_.emplace(entry.object, *entry.bytes);
      continue;
    }
    if (!choice_.force)
      return fail(Errc::negative,
                  formatted("{}:{}: {}: {}", title_, line_of(entry.object), to_string(entry.object),
                            entry.bytes ? "it has another length in the drive" : entry.left_out),
                  "nothing was written; --force restores the rest");
    wanted_.erase(entry.object);
  }
  return {};
}

/// Of a copy that of what it is one of.
std::uint32_t RestoreTarget::line_of(ObjectAddress object) const {
  if (const auto copy = copies_.find(object); copy != copies_.end()) object = copy->second;
  for (const auto& entry : backup_->entries)
    if (entry.object == object) return entry.line;
  return 0;
}

tl::unexpected<Error> RestoreTarget::unfit(Errc code, ObjectAddress object, std::string_view what,
                                           std::string hint) const {
  const auto copy = copies_.find(object);
  const auto of = copy == copies_.end() ? "" : to_string(copy->second) + ": its stored copy ";
  const auto name = of + drive::target_at(desk_->profile, object).in_sentence();
  auto error =
      fail(code, formatted("{}:{}: {}: {}", title_, line_of(object), name, what), std::move(hint)).value();
  error.node = node_;
  error.object = object;
  return fail(std::move(error));
}

/// `outside` tells whether the only thing against it is a limit.
Result<void> RestoreTarget::check_value(ObjectAddress object, const Bytes& data, bool& outside) const {
  const auto target = drive::target_at(desk_->profile, object);
  const auto meaning = drive::fitted(drive::meaning(target, node_), data.size());
  const auto value =
      meaning.type_known ? od::decode(meaning.type, data) : Result<od::Value>(od::Value(std::uint64_t{0}));
  if (!od::writable(meaning.access))
    return unfit(Errc::negative, object, "is read-only", "nothing was written");
  if (!value) return unfit(Errc::negative, object, value.error().message, "nothing was written");
  if (const auto free = check_writable(*desk_, node_, object, data); !free)
    return unfit(Errc::refused, object, free.error().message, "nothing was written; " + free.error().hint);
  const auto limits = meaning.type_known ? drive::check_limits(meaning, *value) : Result<void>{};
  outside = !limits;
  return limits ? limits : unfit(Errc::negative, object, limits.error().message, "nothing was written");
}

/// Nothing is written unless everything can be. What the drive holds already is none of it. A backup of ours
/// says what a drive held, within its limits or not: that is named and stays as it is, and keeps nobody from
/// the rest. What the file says is wrong before what is made of it.
Result<void> RestoreTarget::check_values() {
  const auto of_file = check_each(false);
  return of_file ? check_each(true) : of_file;
}

Result<void> RestoreTarget::check_each(bool copies) {
  for (auto next = wanted_.begin(); next != wanted_.end();) {
    const auto [object, data] = *next++;
    if ((copies_.count(object) > 0) != copies) continue;
    bool outside = false;
    const auto fits = present_.at(object) == data ? Result<void>() : check_value(object, data, outside);
    if (fits) continue;
    auto error = fits.error();
    const bool skipped = choice_.skip_invalid && error.code == Errc::negative;
    if (!skipped && (!outside || !backup_->proven)) {
      if (error.code == Errc::negative) error.hint += "; --skip-invalid restores the rest";
      return fail(std::move(error));
    }
    error.message += "; node " + formatted("{} keeps {}", node_, to_hex(present_.at(object)));
    error.hint = skipped ? "" : "the drive may not accept its own original value again: `write` it if needed";
    left_.push_back(std::move(error));
    wanted_.erase(object);
    present_.erase(object);
  }
  return {};
}

/// What a drive held as a whole, it takes as a whole; what others wrote, or a part, has to fit the PDOs that
/// are there.
Result<void> RestoreTarget::check_pdos() {
  if (backup_->proven) return {};
  const auto changes = [this](const auto& value) {
    return pdo_at(value.first.index) && present_.at(value.first) != value.second;
  };
  if (std::none_of(wanted_.begin(), wanted_.end(), changes)) return {};
  const std::uint8_t nodes[] = {node_};
  auto values = std::move(session::read_pdo_values(*desk_->session, desk_->profile, nodes).front());
  if (!values) return fail(values.error());
  const auto present = session::pdos_of(*values);
  for (const auto& [object, data] : wanted_)
    if (pdo_at(object.index)) values->insert_or_assign(object, data);
  const auto wanted = session::pdos_of(*values);
  for (const auto& was : present) {
    const auto same = [&](const Pdo& pdo) {
      return pdo.direction == was.direction && pdo.number == was.number;
    };
    const auto of_it = [&](const auto& value) {
      return changes(value) &&
             (value.first.index == was.communication_index() || value.first.index == was.mapping_index());
    };
    const auto now = std::find_if(wanted.begin(), wanted.end(), same);
    if (now == wanted.end() || std::none_of(wanted_.begin(), wanted_.end(), of_it)) continue;
    if (const auto fits = check_pdo(*desk_->profile, was, *now, wanted); !fits)
      return unfit(Errc::refused, std::find_if(wanted_.begin(), wanted_.end(), of_it)->first,
                   fits.error().message, "nothing was written; " + fits.error().hint);
  }
  return {};
}

}  // namespace servoctl::settings
