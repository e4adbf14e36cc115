#include "commands/restore_journal.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/number.hpp"
#include "commands/backup_file.hpp"
#include "commands/field_reader.hpp"
#include "drive/drive_settings.hpp"

namespace servoctl::commands {
namespace {

using report::List;
using report::Record;
using report::Value;

constexpr std::uint64_t kVersion = 1;

std::pair<ObjectAddress, Bytes> read_mean(const Value& record, FieldReader& header) {
  FieldReader fields(record, "means");
  const auto index = fields.number("index", true).value_or(0);
  const auto sub = fields.number("sub", true).value_or(0);
  const auto bytes = parse_hex_bytes(fields.text("bytes", true));
  if (fields.error() || !bytes || index > 0xFFFF || sub > 0xFF) header.refuse("means");
  return {{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)}, bytes.value_or(Bytes{})};
}

}  // namespace

std::filesystem::path journal_of(const std::filesystem::path& before) { return before.string() + ".journal"; }

Result<std::optional<RestoreJournal>> read_journal(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::optional<RestoreJournal>();
  const auto text = read_file(path);
  if (!text) return tl::unexpected<Error>(text.error());
  const auto document = report::parse_json(*text, path.string());
  if (!document) return tl::unexpected<Error>(document.error());
  FieldReader fields(*document, path.string());
  if (fields.number("servoctl_journal", true) != kVersion) fields.refuse("servoctl_journal");
  RestoreJournal out;
  out.checksum = fields.text("checksum", true);
  out.node = static_cast<std::uint8_t>(fields.number("node", true).value_or(0));
  out.with_address = fields.flag("with_address");
  out.force = fields.flag("force");
  out.keep = fields.flag("keep");
  out.unlock = fields.flag("unlock");
  const auto* means = report::find(*document, "means");
  const auto* list = means == nullptr ? nullptr : std::get_if<List>(&means->data());
  if (list == nullptr) fields.refuse("means");
  for (const auto& record : list == nullptr ? List() : *list) out.means.push_back(read_mean(record, fields));
  if (fields.error())
    return fail(Errc::file, *fields.error(),
                "this is no journal of a restore; look at it, and take it away if it is none");
  return std::optional(std::move(out));
}

Result<void> write_journal(const std::filesystem::path& path, const RestoreJournal& journal) {
  List means;
  for (const auto& [object, bytes] : journal.means)
    means.emplace_back(Record{{"index", object.index}, {"sub", object.sub}, {"bytes", to_hex(bytes)}});
  const Record document{{"servoctl_journal", kVersion}, {"checksum", journal.checksum},
                        {"node", journal.node},         {"with_address", journal.with_address},
                        {"force", journal.force},       {"keep", journal.keep},
                        {"unlock", journal.unlock},     {"means", std::move(means)}};
  return write_file_atomically(path, report::to_json(document) + "\n");
}

Result<void> note_before(const Context& context, const std::filesystem::path& before,
                         const session::Snapshot& snapshot, RestoreJournal journal) {
  if (journal.means.empty())
    for (const auto& mean : drive::means_of_writing(*context.profile)) {
      const auto value = context.session->upload(journal.node, mean.first);
      if (value) journal.means.emplace_back(mean.first, *value);
      if (!value && value.error().code != Errc::sdo_abort) return tl::unexpected<Error>(value.error());
    }
  const auto saved = write_file_atomically(before, backup_text(context, make_backup(context, snapshot)));
  return saved ? write_journal(journal_of(before), journal) : saved;
}

Result<void> put_means_back(session::Session& session, const RestoreJournal& journal) {
  for (const auto& [object, bytes] : journal.means) {
    const auto present = session.upload(journal.node, object);
    if (!present) return tl::unexpected<Error>(present.error());
    if (*present == bytes) continue;
    if (const auto written = session.download(journal.node, object, bytes); !written) return written;
  }
  return {};
}

}  // namespace servoctl::commands
