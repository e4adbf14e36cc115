#include "pdo/pdo_record.hpp"

#include <algorithm>
#include <utility>

#include "base/bytes.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "session/identify.hpp"
#include "settings/backup_file.hpp"
#include "show/bus_name.hpp"

namespace servoctl::pdo {
namespace {

namespace fs = std::filesystem;
using session::Identity;

std::string name_of_drive(const Identity& drive) {
  std::string out;
  const auto add = [&](std::string_view mark, const std::optional<std::uint32_t>& number) {
    if (number) out += formatted("-{}{:X}", mark, *number);
  };
  add("v", drive.vendor_id);
  add("p", drive.product_code);
  add("s", drive.serial);
  return out;
}

bool is_other_drive(const Identity& one, const Identity& other) {
  const auto differ = [](const auto& a, const auto& b) { return a && b && *a != *b; };
  return differ(one.vendor_id, other.vendor_id) || differ(one.product_code, other.product_code) ||
         differ(one.serial, other.serial);
}

/// Such as `vendor 0x2E, product 0x26, serial 7`.
std::string text_of(const Identity& drive) {
  std::string out;
  const auto add = [&](const std::string& part) { append(out, part); };
  if (drive.vendor_id) add(formatted("vendor 0x{:X}", *drive.vendor_id));
  if (drive.product_code) add(formatted("product 0x{:X}", *drive.product_code));
  if (drive.serial) add(formatted("serial {}", *drive.serial));
  return out.empty() ? "unknown" : out;
}

}  // namespace

PdoRecord::PdoRecord(const show::Desk& desk, std::uint8_t node)
    : desk_(&desk),
      node_(node),
      name_(formatted("pdos-before-{}-node-{}", show::bus_name(desk.session->url()), node)) {}

/// Of any drive that has been this node. The journal is written last and removed first.
std::vector<fs::path> PdoRecord::found() const {
  std::vector<fs::path> out;
  if (desk_->state_folder.empty()) return out;
  std::error_code none;
  for (fs::directory_iterator at(desk_->state_folder, none), end; !none && at != end; at.increment(none)) {
    const auto name = at->path().filename().string();
    const bool ours = name.starts_with(name_) && name.size() > name_.size() &&
                      (name[name_.size()] == '.' || name[name_.size()] == '-');
    if (ours && name.ends_with(".json") && fs::exists(settings::journal_of(at->path()), none))
      out.push_back(at->path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

Result<void> PdoRecord::begin(const session::Values& present, bool keep, bool unlock) {
  if (desk_->state_folder.empty()) return {};
  auto drive = session::read_identity(*desk_->session, node_);
  if (!drive) return fail(drive.error());
  for (const auto& older : found())
    if (const auto backup = settings::read_backup(older); backup && !is_other_drive(backup->identity, *drive))
      return {};
  file_ = desk_->state_folder / (name_ + name_of_drive(*drive) + ".json");
  session::Snapshot snapshot;
  snapshot.identity = std::move(*drive);
  for (const auto& [object, data] : present) snapshot.entries.push_back({object, data, {}});
  settings::RestoreJournal journal;
  journal.checksum = settings::checksum(settings::make_backup(*desk_, snapshot));
  journal.node = node_;
  journal.keep = keep;
  journal.unlock = unlock;
  const auto noted = settings::note_before(*desk_, file_, snapshot, std::move(journal));
  mine_ = noted.has_value();
  return noted;
}

Result<std::optional<settings::RestoreJournal>> PdoRecord::take_up(const fs::path& file) {
  std::error_code none;
  for (const auto& record : found()) {
    if (!fs::equivalent(file, record, none)) continue;
    const auto backup = settings::read_backup(record);
    if (!backup) return fail(backup.error());
    const auto drive = session::read_identity(*desk_->session, node_);
    if (!drive) return fail(drive.error());
    if (is_other_drive(backup->identity, *drive))
      return fail(Errc::refused,
                  message("node {} ({}) is not the drive whose change was interrupted ({})", node_name(node_),
                          text_of(*drive), text_of(backup->identity)),
                  "reconnect that drive at its node-ID, or copy the PDOs by `pdo save` and `pdo apply`");
    mine_ = true;
    file_ = record;
    return settings::read_journal(*desk_, settings::journal_of(record));
  }
  return std::optional<settings::RestoreJournal>();
}

void PdoRecord::settle() {
  if (!mine_) return;
  std::error_code ignored;
  fs::remove(settings::journal_of(file_), ignored);
  fs::remove(file_, ignored);
  mine_ = false;
}

Message PdoRecord::notice_of(const fs::path& record, const std::optional<Identity>& drive) const {
  const auto backup = settings::read_backup(record);
  const auto since = backup ? message(", begun at {},", as_it_is(backup->time)) : Message();
  if (backup && drive && is_other_drive(backup->identity, *drive))
    return message(
        "node {}: a PDO change of another drive that was node {} here ({}){} was interrupted; {} holds that "
        "drive's old PDOs (delete the file if not needed)",
        node_name(node_), node_, text_of(backup->identity), since, as_it_is(record.string()));
  return message(
      "node {}: a change of its PDOs{} was interrupted; `pdo apply {} -n {}{}` restores the old ones (delete "
      "the file if not needed)",
      node_name(node_), since, as_it_is(record.string()), node_name(node_),
      backup ? message(" -d {}", as_it_is(backup->family)) : Message());
}

std::vector<Message> PdoRecord::notices() const {
  const auto records = found();
  std::vector<Message> out;
  if (records.empty()) return out;
  const auto drive = session::read_identity(*desk_->session, node_);
  for (const auto& record : records)
    out.push_back(notice_of(record, drive ? std::optional(*drive) : std::nullopt));
  return out;
}

void tell_cut_off_changes(show::Desk& desk) {
  for (const auto node : desk.nodes)
    for (auto& notice : PdoRecord(desk, node).notices()) desk.notices.push_back(std::move(notice));
}

}  // namespace servoctl::pdo
