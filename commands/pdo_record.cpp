#include "commands/pdo_record.hpp"

#include <fmt/format.h>
#include <cctype>

#include "commands/backup_file.hpp"

namespace servoctl::commands {
namespace {

namespace fs = std::filesystem;

/// A bus as a part of a file's name; a long one (a simulated cabinet) is cut.
std::string name_of_bus(std::string_view url) {
  constexpr std::size_t kMost = 100;
  std::string out(url.substr(0, kMost));
  for (auto& c : out)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  return out;
}

}  // namespace

PdoRecord::PdoRecord(const Context& context, std::uint8_t node) : context_(&context), node_(node) {
  if (!context.state_folder.empty())
    file_ = context.state_folder /
            fmt::format("pdos-before-{}-node-{}.json", name_of_bus(context.session->url()), node);
}

/// The journal is written last and removed first.
bool PdoRecord::exists() const {
  std::error_code none;
  return !file_.empty() && fs::exists(journal_of(file_), none);
}

Result<void> PdoRecord::begin(const session::Values& present, bool keep, bool unlock) {
  if (file_.empty() || exists()) return {};
  session::Snapshot snapshot;
  snapshot.identity.node = node_;
  for (const auto& [object, data] : present) snapshot.entries.push_back({object, data, {}});
  RestoreJournal journal;
  journal.checksum = checksum(make_backup(*context_, snapshot));
  journal.node = node_;
  journal.keep = keep;
  journal.unlock = unlock;
  const auto noted = note_before(*context_, file_, snapshot, std::move(journal));
  mine_ = noted.has_value();
  return noted;
}

Result<std::optional<RestoreJournal>> PdoRecord::take_up(const fs::path& file) {
  std::error_code none;
  if (!exists() || !fs::equivalent(file, file_, none)) return std::optional<RestoreJournal>();
  mine_ = true;
  return read_journal(journal_of(file_));
}

void PdoRecord::settle() {
  if (!mine_) return;
  std::error_code ignored;
  fs::remove(journal_of(file_), ignored);
  fs::remove(file_, ignored);
  mine_ = false;
}

std::string PdoRecord::notice() const {
  if (!exists()) return {};
  const auto backup = read_backup(file_);
  return fmt::format(
      "node {}: a change of its PDOs{} did not come to its end; `pdo apply {} -n {}{}` puts back what they "
      "were (delete the file when that is not wanted)",
      node_, backup ? ", begun at " + backup->time + "," : "", file_.string(), node_,
      backup ? " -d " + backup->family : "");
}

void tell_cut_off_changes(Context& context) {
  for (const auto node : context.nodes)
    if (auto notice = PdoRecord(context, node).notice(); !notice.empty())
      context.notices.push_back(std::move(notice));
}

}  // namespace servoctl::commands
