#include "base/format.hpp"
#include "settings/backup_formats.hpp"
#include "show/field_reader.hpp"
#include "show/identity.hpp"

#include <algorithm>
#include <unordered_set>

#include "base/checksum.hpp"
#include "show/reading.hpp"

namespace servoctl::settings {
namespace {

using report::List;
using report::Record;
using report::Value;

constexpr std::int64_t kBackupVersion = 1;

Record entry_record(const drive::Profile* profile, const Backup& backup, const Backup::Entry& entry) {
  show::DecodedValue decoded;
  if (entry.bytes) {
    const show::Reading reading{backup.identity.node, drive::target_at(profile, entry.object), entry.type,
                                *entry.bytes};
    decoded = show::decode_value(reading, *entry.bytes);
  }
  return {{"id", report::text_or_null(entry.id)},
          {"index", entry.object.index},
          {"sub", entry.object.sub},
          {"name", report::text_or_null(entry.name)},
          {"type", od::name(entry.type)},
          {"bytes", entry.bytes ? Value(to_hex(*entry.bytes)) : Value()},
          {"value", decoded.value},
          {"unit", report::text_or_null(decoded.unit)},
          {"label", decoded.label},
          {"left_out", report::text_or_null(entry.left_out)}};
}

session::Identity read_identity(const Value& record, std::uint8_t node, show::FieldReader& header) {
  const auto* inside = report::find(record, "identity");
  const auto out = inside == nullptr ? std::nullopt : show::identity_of(*inside, node);
  if (!out) header.refuse("identity");
  return out.value_or(session::Identity{});
}

Result<Backup::Entry> read_entry(const Value& record, std::uint32_t line, std::string_view file) {
  const auto where = message("{}:{}", as_it_is(file), line);
  show::FieldReader fields(record, where);
  Backup::Entry out;
  out.line = line;
  out.id = fields.text("id");
  out.name = fields.text("name");
  out.left_out = fields.text("left_out");
  const auto index = fields.number("index", true).value_or(0);
  const auto sub = fields.number("sub", true).value_or(0);
  if (index > 0xFFFF) fields.refuse("index");
  if (sub > 0xFF) fields.refuse("sub");
  out.object = {static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)};
  const auto type = od::parse_data_type(fields.text("type", true));
  if (!type) fields.refuse("type");
  out.type = type.value_or(od::DataType::bytes);
  const auto* bytes = report::find(record, "bytes");
  if (bytes != nullptr && !bytes->is_null()) {
    out.bytes = parse_hex_bytes(fields.text("bytes"));
    const auto size = od::size_of(out.type);
    if (!out.bytes || (size && out.bytes->size() != *size)) fields.refuse("bytes");
  } else if (out.left_out.empty()) {
    fields.refuse("bytes");
  }
  if (fields.error()) return fail(Errc::file, *fields.error(), "make the backup again");
  return out;
}

/// Where the entries begin in the text, a line each: what backup_text() writes.
std::uint32_t first_entry_line(std::string_view text) {
  const auto place = text.find("\"entries\"");
  return static_cast<std::uint32_t>(
      2 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(place, text.size())),
                     '\n'));
}

Result<void> read_entries(const Value& document, std::uint32_t line, std::string_view file, Backup& out) {
  const auto* list = report::find(document, "entries");
  const auto* entries = list == nullptr ? nullptr : std::get_if<List>(&list->data());
  if (entries == nullptr)
    return fail(Errc::file, message("{}: 'entries' is missing or wrong", as_it_is(file)));
  std::unordered_set<ObjectAddress> seen;
  for (const auto& record : *entries) {
    auto entry = read_entry(record, line++, file);
    if (!entry) return fail(entry.error());
    if (!seen.insert(entry->object).second)
      return fail(Errc::file,
                  message("{}:{}: {} appears twice", as_it_is(file), entry->line, to_string(entry->object)));
    out.entries.push_back(std::move(*entry));
  }
  return {};
}

}  // namespace

std::string checksum(const Backup& backup) {
  Checksum sum;
  sum.add(backup.family);
  for (const auto& entry : backup.entries)
    sum.add(formatted("\n{} {} {} {}", to_string(entry.object), od::name(entry.type),
                      entry.bytes ? to_hex(*entry.bytes, "") : "-", entry.left_out));
  return sum.text();
}

std::string json_text(const drive::Profile* profile, const Backup& backup) {
  const Record head{{"servoctl_backup", kBackupVersion},
                    {"tool", backup.tool},
                    {"time", backup.time},
                    {"bus", backup.bus},
                    {"node", backup.identity.node},
                    {"family", backup.family},
                    {"identity", show::identity_record(backup.identity)},
                    {"checksum", checksum(backup)}};
  auto out = report::to_json(head);
  out.pop_back();
  out += ",\n\"entries\":[\n";
  for (std::size_t i = 0; i < backup.entries.size(); ++i)
    out += report::to_json(entry_record(profile, backup, backup.entries[i])) +
           (i + 1 < backup.entries.size() ? ",\n" : "\n");
  return out + "]}\n";
}

Result<Backup> read_json_backup(std::string_view text, const std::string& file) {
  const auto document = report::parse_json(text, file);
  if (!document) return fail(document.error());
  show::FieldReader fields(*document, as_it_is(file));
  const auto version = fields.number("servoctl_backup", true);
  if (!version) return fail(Errc::file, message("{}: this is not a servoctl backup", as_it_is(file)));
  if (*version > static_cast<std::uint64_t>(kBackupVersion))
    return fail(Errc::file,
                message("{}: its version {} is newer than this program supports ({})", as_it_is(file),
                        *version, kBackupVersion),
                "read it with the servoctl that wrote it, or a newer one");
  Backup out;
  out.tool = fields.text("tool");
  out.time = fields.text("time");
  out.bus = fields.text("bus");
  out.family = fields.text("family", true);
  const auto node = fields.number("node", true).value_or(0);
  if (node < 1 || node > 127) fields.refuse("node");
  out.identity = read_identity(*document, static_cast<std::uint8_t>(node), fields);
  const auto sum = fields.text("checksum", true);
  if (fields.error()) return fail(Errc::file, *fields.error(), "make the backup again");
  if (const auto read = read_entries(*document, first_entry_line(text), file, out); !read)
    return fail(read.error());
  if (sum != checksum(out))
    return fail(
        Errc::file,
        message("{}: its checksum does not match: the file was changed after it was written", as_it_is(file)),
        "make the backup again");
  out.proven = true;
  return out;
}

}  // namespace servoctl::settings
