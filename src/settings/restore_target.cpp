#include "settings/restore_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/format.hpp"
#include "drive/cia402.hpp"
#include "drive/drive_settings.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "session/pdo_change.hpp"
#include "session/pdo_cob_ids.hpp"
#include "settings/comparison.hpp"
#include "settings/kept_address.hpp"
#include "show/identity.hpp"

namespace servoctl::settings {

Result<void> RestoreTarget::prepare() {
  for (const auto step : {&RestoreTarget::check_identity, &RestoreTarget::choose_values,
                          &RestoreTarget::read_present, &RestoreTarget::compare_undecided})
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
                message("{} is for {}, not for {}", title_, as_it_is(backup_->family),
                        as_it_is(desk_->profile->family)),
                "--force restores what fits anyway");
  const std::uint8_t nodes[] = {node_};
  const auto found = session::scan(*desk_->session, nodes);
  if (!found) return fail(found.error());
  if (found->empty())
    return fail(Errc::timeout, message("node {} does not answer", node_name(node_)), "`scan` shows who does");
  identity_ = found->front();
  const auto& drive = identity_;
  if (const auto what = show::other_kind(backup_->identity, drive); !what.empty() && !force)
    return fail(Errc::refused,
                message("node {} is not the drive of {}: {} differs", node_name(node_), title_, what),
                "--force restores what fits anyway");
  const bool says_firmware = backup_->identity.revision || !backup_->identity.software_version.empty();
  if (says_firmware && !drive.by_registers &&
      (backup_->identity.revision != drive.revision ||
       backup_->identity.software_version != drive.software_version))
    desk_->notices.push_back(message(
        "node {}: its firmware differs from the backup's: check the important values", node_name(node_)));
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
  return fail(Errc::refused,
              message("node {} is energised: its settings cannot be changed now", node_name(node_)),
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
                            message("{} is not 0: it may be enabled, or its motor turns; its settings "
                                    "cannot be changed now",
                                    as_it_is(name)),
                            "stop and disable it first; make sure that the load is held"));
  }
  return {};
}

/// Only what this drive's own data calls a setting is ever written, whatever the file says.
Result<void> RestoreTarget::leave_out(const Backup::Entry& entry, std::string_view reason) {
  const auto what = message("{}: {} is not a setting of this drive: {}", place_of(entry.object),
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
      message("node {}: {} stays as it is: a drive that an input enables would follow it at once",
              node_name(node_), drive::target_at(desk_->profile, entry.object).in_sentence()));
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
    if (is_out_of_reach(entry)) continue;
    const bool address = is_own_address(entry.object);
    if (!entry.bytes || (address && !choice_.with_address)) continue;
    if (const auto answers = check_line_address(entry); !answers) return answers;
    const auto setting = settings.find(entry.object);
    const auto reason =
        setting == settings.end() ? std::string_view("not in its data, or read-only") : setting->second;
    auto& values = undecided.contains(entry.object) ? unsent_wanted_ : wanted_;
    if (reason.empty())
      values.emplace(entry.object, address ? *entry.bytes
                                           : for_node(desk_->profile, entry.object, *entry.bytes,
                                                      backup_->identity.node, node_));
    else if (const auto left_out = leave_out(entry, reason); !left_out)
      return left_out;
  }
  for (const auto object : undecided) settings.erase(object);
  if (choice_.keep) add_copies(settings);
  tell_kept();
  return {};
}

void RestoreTarget::tell_kept() const {
  if (unreachable_ > 0)
    desk_->notices.push_back(message("node {}: {} values of {} have no Modbus register and stay as they are",
                                     node_name(node_), unreachable_, title_));
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
                  message("{}: {}: {}", place_of(entry.object), to_string(entry.object),
                          entry.bytes ? "it has another length in the drive" : entry.left_out),
                  "nothing was written; --force restores the rest");
    wanted_.erase(entry.object);
  }
  return {};
}

/// They are read as the others are: a drive that holds other ones is not restored.
Result<void> RestoreTarget::compare_undecided() {
  std::vector<ObjectAddress> objects;
  for (const auto& value : unsent_wanted_) objects.push_back(value.first);
  const auto read = session::read_objects(*desk_->session, node_, objects);
  if (!read) return fail(read.error());
  constexpr std::size_t kMostListed = 4;
  std::vector<std::string> differing;
  for (const auto& entry : *read) {
    if (entry.bytes) unsent_present_.emplace(entry.object, *entry.bytes);
    if (entry.bytes != unsent_wanted_.at(entry.object)) differing.push_back(to_string(entry.object));
  }
  if (differing.empty()) return {};
  const auto all = differing.size();
  left_count_ += all;
  differing.resize(std::min(all, kMostListed));
  auto names = message("{}", NameList{differing});
  if (all > kMostListed) names += message(" and {} more", all - kMostListed);
  left_.push_back(drive_error(
      Errc::negative, node_,
      all == 1
          ? message("{} differs from {} and is left as it is: it is not known to be writable", names, title_)
          : message("{} values differ from {} and are left as they are: it is not known whether they can be "
                    "written ({})",
                    all, title_, names),
      message("where the manual says so, change AccessType to rw in {}",
              as_it_is(desk_->profile->data_sheet.string()))));
  return {};
}

std::size_t RestoreTarget::to_write() const {
  return static_cast<std::size_t>(std::count_if(wanted_.begin(), wanted_.end(), [this](const auto& value) {
    return present_.at(value.first) != value.second;
  }));
}

session::Values RestoreTarget::wanted_and_left() const {
  auto out = wanted_;
  out.insert(unsent_wanted_.begin(), unsent_wanted_.end());
  return out;
}

session::Values RestoreTarget::present_and_left() const {
  auto out = present_;
  out.insert(unsent_present_.begin(), unsent_present_.end());
  return out;
}

/// Of a copy that of what it is one of.
std::uint32_t RestoreTarget::line_of(ObjectAddress object) const {
  if (const auto copy = copies_.find(object); copy != copies_.end()) object = copy->second;
  for (const auto& entry : backup_->entries)
    if (entry.object == object) return entry.line;
  return 0;
}

/// A drive that is cloned has no lines.
Message RestoreTarget::place_of(ObjectAddress object) const {
  const auto line = line_of(object);
  return line == 0 ? title_ : message("{}:{}", title_, line);
}

}  // namespace servoctl::settings
