#include "settings/backup_file.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "drive/standard_objects.hpp"
#include "od/data_sheet.hpp"
#include "od/eds_section.hpp"
#include "od/text_encoding.hpp"
#include "session/cob_id_check.hpp"
#include "settings/backup_formats.hpp"
#include "show/reading.hpp"

namespace servoctl::settings {
namespace {

/// Stands between a COB-ID and why no drive may have it.
constexpr std::string_view kConflict = ", a COB-ID that is none: ";

constexpr std::string_view kExtensions[] = {".json", ".dcf", ".csv", ".servoctl"};

/// The first line that is neither empty nor a comment of INI files or of batch files.
std::string_view first_line(std::string_view text) {
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    const auto line = trim(text.substr(0, end));
    if (!line.empty() && line.front() != ';' && line.front() != '#') return line;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return {};
}

/// `[FileInfo]`, and not the `[7]` before a line of CiA 309-3 nor a JSON list.
bool begins_section(std::string_view line) {
  return line.size() > 2 && line.front() == '[' && line.back() == ']' &&
         std::all_of(line.begin() + 1, line.end() - 1,
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

bool is_table_head(std::string_view line) {
  const auto columns = split(line, ',');
  return std::any_of(columns.begin(), columns.end(), [](std::string_view column) {
    const auto name = trim(column);
    return equals_nocase(name, "index") || equals_nocase(name, "\"index\"");
  });
}

/// `text` is what the bytes say in UTF-8.
BackupFormat guess_format(std::string_view bytes, std::string_view text, const std::string& extension) {
  if (extension == ".json") return BackupFormat::json;
  // Every number of a concise DCF has bytes that no text has; UTF-16 has them as well, and a mark before.
  const auto encoding = od::guess_encoding(bytes);
  const bool wide = encoding == od::TextEncoding::utf16le || encoding == od::TextEncoding::utf16be;
  if (!wide && bytes.find('\0') != std::string_view::npos) return BackupFormat::concise_dcf;
  const auto line = first_line(text);
  if (line.empty() || line.front() == '{') return BackupFormat::json;
  // An ESI is a data sheet as well; it has no values.
  if (line.front() == '<' || begins_section(line) || extension == ".dcf" || extension == ".eds")
    return BackupFormat::dcf;
  if (is_table_head(line) || extension == ".csv") return BackupFormat::csv;
  return line == "[]" || line.starts_with("[[") ? BackupFormat::json : BackupFormat::batch;
}

std::string_view title_of(BackupFormat format) {
  switch (format) {
    case BackupFormat::json: return "backup of servoctl";
    case BackupFormat::dcf: return "DCF";
    case BackupFormat::csv: return "table";
    case BackupFormat::batch: return "list of command lines";
    case BackupFormat::concise_dcf: return "concise DCF";
  }
  return {};
}

/// What the family's own data sheet says although its drives may say something else, proves no other drive.
void forget_soft_marks(const drive::Profile& profile, session::Identity& identity) {
  for (const auto& mark : profile.rules.identity) {
    if (!mark.soft) continue;
    if (mark.object == objects::kVendorId && identity.vendor_id == mark.value) identity.vendor_id.reset();
    if (mark.object == objects::kProductCode && identity.product_code == mark.value)
      identity.product_code.reset();
  }
}

Result<Backup> read_foreign(const BackupSource& source, const drive::Profile& profile, std::uint8_t node) {
  switch (source.format) {
    case BackupFormat::dcf: return read_dcf_backup(source.text, source.file, node);
    case BackupFormat::csv: return read_csv_backup(source.text, source.file, profile, node);
    case BackupFormat::batch:
      if (source.lines == nullptr)
        return fail(Errc::file, message("{}: command lines are not understood here", as_it_is(source.file)));
      return read_batch_backup(*source.lines, source.text, source.file, profile, node);
    default: return read_concise_dcf(source.text, source.file);
  }
}

/// What the reader of a restore must know: no checksum, no identity, and what is not written.
void tell(show::Desk& desk, const BackupSource& source, const Backup& backup) {
  // That it fits itself says nothing.
  const auto fits = backup.family == source.file
                        ? Message()
                        : Message("; its objects and values fit ") + as_it_is(backup.family);
  desk.notices.push_back(message("{} is a {}: it proves neither its drive nor its completeness{}",
                                 as_it_is(source.file), title_of(source.format), fits));
  constexpr std::size_t kMostNamed = 4;
  for (std::size_t i = 0; i < std::min(kMostNamed, backup.passed_over.size()); ++i)
    desk.notices.push_back(backup.passed_over[i]);
  if (backup.passed_over.size() > kMostNamed)
    desk.notices.push_back(
        message("{}: {} more like this", as_it_is(source.file), backup.passed_over.size() - kMostNamed));
  std::size_t left_out = 0;
  Message names;
  for (const auto& entry : backup.entries) {
    if (entry.bytes || ++left_out > kMostNamed) continue;
    names += message("{}{} {} ({})", names.empty() ? "" : ", ", to_string(entry.object), as_it_is(entry.name),
                     entry.left_out);
  }
  if (left_out > kMostNamed) names += message(" and {} more", left_out - kMostNamed);
  if (left_out > 0)
    desk.notices.push_back(message("{}: not settings, left out: {}", as_it_is(source.file), names));
}

/// All are named, none is left out without being told to.
Result<void> judge_unusable(show::Desk& desk, const Backup& backup, bool skip_invalid) {
  auto& errors = desk.errors;
  if (skip_invalid || backup.unusable.empty()) {
    for (auto error : backup.unusable) {
      error.code = Errc::negative;
      error.message += "; it is left out";
      error.hint = {};
      errors.push_back(std::move(error));
    }
    return {};
  }
  errors.insert(errors.end(), backup.unusable.begin() + 1, backup.unusable.end());
  auto error = backup.unusable.front();
  const Message joint = error.hint.empty() ? Message() : Message("; ");
  error.hint += backup.unusable.size() == 1
                    ? message("{}--skip-invalid leaves it out", joint)
                    : message("{}--skip-invalid leaves these {} out", joint, backup.unusable.size());
  return fail(std::move(error));
}

}  // namespace

BackupFormat format_of(const std::filesystem::path& file, std::string_view word) {
  const auto extension = lower(file.extension().string());
  if (word.empty() && extension == ".txt") return BackupFormat::batch;
  for (std::size_t i = 0; i < std::size(kBackupFormats); ++i)
    if (word.empty() ? kExtensions[i] == extension : kBackupFormats[i] == word)
      return static_cast<BackupFormat>(i);
  return BackupFormat::json;
}

std::string_view extension_of(BackupFormat format) {
  const auto place = static_cast<std::size_t>(format);
  return place < std::size(kExtensions) ? kExtensions[place] : std::string_view();
}

Backup make_backup(const show::Desk& desk, const session::Snapshot& snapshot) {
  Backup out;
  out.proven = true;
  out.family = desk.profile->family;
  out.tool = formatted("servoctl {}", version());
  out.time = utc_now_text();
  out.bus = desk.session->url();
  out.identity = snapshot.identity;
  for (const auto& entry : snapshot.entries) {
    const auto target = drive::target_at(desk.profile, entry.object);
    Backup::Entry stored;
    stored.object = entry.object;
    stored.id = target.parameter != nullptr ? target.parameter->id : std::string();
    stored.name = target.parameter != nullptr ? target.parameter->name : target.label();
    const show::Reading reading{snapshot.identity.node, target, {}, entry.bytes.value_or(Bytes{})};
    stored.type = entry.bytes               ? show::type_of(reading, *entry.bytes)
                  : target.entry != nullptr ? target.entry->type
                                            : od::DataType::bytes;
    stored.bytes = entry.bytes;
    stored.left_out = entry.left_out;
    // No drive gets it back: a backup that says so is taken all the same.
    if (entry.bytes)
      if (const auto free =
              session::check_cob_id(desk.profile, entry.object, *entry.bytes, snapshot.identity.node);
          !free) {
        stored.left_out =
            formatted("0x{:08X}{}{}", load_le(*entry.bytes), kConflict, free.error().message.text());
        stored.bytes.reset();
      }
    out.entries.push_back(std::move(stored));
  }
  return out;
}

void tell_left_out(show::Desk& desk, const Backup& backup) {
  for (const auto& entry : backup.entries)
    if (!entry.bytes && entry.left_out.find(kConflict) != std::string::npos)
      desk.notices.push_back(message("node {}: {} {} is left out: {}", node_name(backup.identity.node),
                                     to_string(entry.object), entry.name, entry.left_out));
}

std::string backup_text(const show::Desk& desk, const Backup& backup) {
  return json_text(desk.profile, backup);
}

Result<std::string> backup_text(show::Desk& desk, const Backup& backup, BackupFormat format,
                                const std::filesystem::path& file) {
  switch (format) {
    case BackupFormat::dcf: return dcf_text(*desk.profile, backup, file.filename().string(), desk.notices);
    case BackupFormat::csv: return csv_text(*desk.profile, backup);
    case BackupFormat::batch: return batch_text(*desk.profile, backup);
    default: return json_text(desk.profile, backup);
  }
}

Result<BackupSource> open_backup(const std::filesystem::path& file, LineReader* lines) {
  const auto bytes = read_file(od::sheet_name(file.string()).path);
  if (!bytes) return fail(bytes.error());
  // Spreadsheets save tables in whatever encoding their system has.
  const auto decoded = od::to_utf8(*bytes);
  const auto text = decoded.text(*bytes);
  const auto format = guess_format(*bytes, text, lower(file.extension().string()));
  return BackupSource{file.string(), std::string(format == BackupFormat::concise_dcf ? *bytes : text), format,
                      lines};
}

bool is_backup(const std::filesystem::path& file, LineReader* lines) {
  const auto source = open_backup(file, lines);
  if (!source) return false;
  const std::string_view text = source->text;
  if (trim(text).empty()) return true;
  const auto line = first_line(text);
  switch (source->format) {
    case BackupFormat::json: {
      const auto document = report::parse_json(text, source->file);
      return document && report::find(*document, "servoctl_backup") != nullptr;
    }
    case BackupFormat::dcf: return begins_section(line);
    case BackupFormat::csv: return is_table_head(line);
    case BackupFormat::batch: return lines != nullptr && lines->setting_lines(text, source->file).has_value();
    case BackupFormat::concise_dcf: break;
  }
  return false;
}

std::string family_of(const BackupSource& source) {
  if (source.format == BackupFormat::json) {
    const auto document = report::parse_json(source.text, source.file);
    const auto* family = document ? report::find(*document, "family") : nullptr;
    const auto* name = family == nullptr ? nullptr : std::get_if<std::string>(&family->data());
    return name == nullptr ? std::string() : *name;
  }
  if (source.format != BackupFormat::batch || source.lines == nullptr) return {};
  const auto lines = source.lines->setting_lines(source.text, source.file);
  if (lines)
    for (const auto& line : *lines)
      if (!line.family.empty()) return line.family;
  return {};
}

Result<Backup> read_backup(show::Desk& desk, const BackupSource& source, const drive::Profile* profile,
                           std::uint8_t node, bool skip_invalid) {
  if (source.format == BackupFormat::json) return read_json_backup(source.text, source.file);
  if (profile == nullptr)
    return fail(Errc::usage, message("{} does not name its drive family", as_it_is(source.file)),
                "add -d FAMILY; `drives` lists families");
  auto backup = read_foreign(source, *profile, node);
  if (!backup) return backup;
  if (backup->identity.node == 0) backup->identity.node = node;
  forget_soft_marks(*profile, backup->identity);
  const bool procedure = source.format == BackupFormat::batch || source.format == BackupFormat::concise_dcf;
  settle(*backup, source.file, *profile, procedure);
  if (const auto usable = judge_unusable(desk, *backup, skip_invalid); !usable) return fail(usable.error());
  tell(desk, source, *backup);
  return backup;
}

Result<Backup> read_backup(show::Desk& desk, const std::filesystem::path& file, LineReader* lines,
                           std::uint8_t node, bool skip_invalid) {
  const auto source = open_backup(file, lines);
  if (!source) return fail(source.error());
  return read_backup(desk, *source, desk.profile, node, skip_invalid);
}

Result<Backup> read_backup(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return fail(text.error());
  return read_json_backup(*text, file.string());
}

}  // namespace servoctl::settings
