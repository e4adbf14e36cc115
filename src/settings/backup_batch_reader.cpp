
#include "base/format.hpp"
#include "settings/backup_formats.hpp"
#include "settings/change.hpp"

namespace servoctl::settings {
namespace {

/// Reads the lines of a batch file as values.
class BatchBackupReader {
 public:
  BatchBackupReader(const std::string& file, const drive::Profile& profile, std::uint8_t node)
      : file_(&file), profile_(&profile), node_(node) {}

  Result<void> take(const SettingLine& line) {
    line_ = &line;
    if (const auto chosen = check_choice(); !chosen) return chosen;
    if (!line.values) return refuse(line.values.error().message, line.values.error().hint);
    for (const auto& value : *line.values)
      if (const auto added = add(value.panel ? drive::resolve_panel(*profile_, value.name)
                                             : drive::resolve(profile_, value.name),
                                 value.value, value.type);
          !added)
        return added;
    return {};
  }

  Backup take_backup() { return std::move(out_); }

 private:
  Result<void> check_choice() {
    if (!line_->family.empty() && line_->family != profile_->family)
      return refuse(message("is for {}, not for {}", as_it_is(line_->family), as_it_is(profile_->family)),
                    "give the file's family with -d if the drive really is one");
    if (line_->nodes.empty()) return {};
    if (line_->nodes.size() != 1 || line_->nodes.front() == 0 ||
        (out_.identity.node != 0 && out_.identity.node != line_->nodes.front()))
      return refuse("is for another node than the lines before", "a file holds the settings of one drive");
    out_.identity.node = line_->nodes.front();
    return {};
  }

  Result<void> add(const Result<drive::Target>& target, std::string_view text,
                   std::optional<od::DataType> type) {
    if (!target) return refuse(target.error().message, target.error().hint);
    // The password is given and taken back by whoever writes the values.
    const auto& unlock = profile_->rules.store.unlock;
    if (!unlock.empty() && target->parameter != nullptr && target->parameter == profile_->parameter(unlock))
      return {};
    auto meaning = drive::meaning(*target, node_);
    if (type) meaning = drive::fitted(meaning, od::size_of(*type).value_or(0));
    if (!type && !meaning.size_known)
      return refuse(message("the manual does not tell the length of {}", target->in_sentence()),
                    "write it with a type: write OBJECT VALUE --type i32");
    if (drive::needs_bridge(meaning, text))
      return refuse(message("only the drive itself can convert '{}'", as_it_is(text)),
                    "write the raw number");
    const auto value = drive::parse_quantity(meaning, text);
    const auto bytes = value ? od::encode(meaning.type, *value) : Result<Bytes>(fail(value.error()));
    if (!bytes)
      return refuse(message("{}: {}", target->in_sentence(), bytes.error().message), bytes.error().hint);
    Backup::Entry entry;
    entry.object = target->address;
    entry.type = meaning.type;
    entry.bytes = *bytes;
    entry.line = line_->line;
    out_.entries.push_back(std::move(entry));
    return {};
  }

  tl::unexpected<Error> refuse(const Message& what, Message hint) const {
    auto error =
        fail(Errc::file, message("{}:{}: {}", as_it_is(*file_), line_->line, what), std::move(hint)).value();
    error.line = line_->line;
    return fail(std::move(error));
  }

  const std::string* file_;
  const drive::Profile* profile_;
  std::uint8_t node_;
  const SettingLine* line_ = nullptr;
  Backup out_;
};

}  // namespace

Result<Backup> read_batch_backup(LineReader& lines_of, std::string_view text, const std::string& file,
                                 const drive::Profile& profile, std::uint8_t node) {
  const auto lines = lines_of.setting_lines(text, file);
  if (!lines) return fail(lines.error());
  BatchBackupReader reader(file, profile, node);
  for (const auto& line : *lines)
    if (const auto taken = reader.take(line); !taken) return fail(taken.error());
  auto backup = reader.take_backup();
  if (backup.entries.empty())
    return fail(Errc::file, message("{}: no line in it writes a value", as_it_is(file)),
                "a backup is JSON, a DCF, a table or lines such as `param set Pn0202=2`");
  return backup;
}

}  // namespace servoctl::settings
