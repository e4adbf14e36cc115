#include "settings/restore_journal.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "base/checksum.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "canopen/cob_id.hpp"
#include "drive/drive_settings.hpp"
#include "drive/quantity.hpp"
#include "session/setting_write.hpp"
#include "settings/backup_file.hpp"
#include "show/field_reader.hpp"

namespace servoctl::settings {
namespace {

using report::List;
using report::Record;
using report::Value;

constexpr std::uintmax_t kMostBytes = 1U << 20U;
constexpr std::uint64_t kJournalVersion = 2;  ///< 1 had no seal.
constexpr std::string_view kKeys[] = {"servoctl_journal", "checksum", "node", "with_address", "force", "keep",
                                      "unlock",           "means",    "seal"};

tl::unexpected<Error> no_journal(Message message) {
  return fail(Errc::file, std::move(message),
              "it belongs to an interrupted restore; delete it if that is not to be resumed");
}

Record body_of(const RestoreJournal& journal) {
  List means;
  for (const auto& [object, bytes] : journal.means)
    means.emplace_back(Record{{"index", object.index}, {"sub", object.sub}, {"bytes", to_hex(bytes)}});
  return {{"servoctl_journal", kJournalVersion},
          {"checksum", journal.checksum},
          {"node", journal.node},
          {"with_address", journal.with_address},
          {"force", journal.force},
          {"keep", journal.keep},
          {"unlock", journal.unlock},
          {"means", std::move(means)}};
}

/// Of all that the journal says: an edited one, and one whose end is missing, is noticed.
std::string seal_of(const RestoreJournal& journal) { return checksum_of(report::to_json(body_of(journal))); }

std::pair<ObjectAddress, Bytes> read_mean(const Value& record, show::FieldReader& header) {
  show::FieldReader fields(record, "means");
  const auto index = fields.number("index", true).value_or(0);
  const auto sub = fields.number("sub", true).value_or(0);
  const auto bytes = parse_hex_bytes(fields.text("bytes", true));
  if (fields.error() || !bytes || index > 0xFFFF || sub > 0xFF) header.refuse("means");
  return {{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)}, bytes.value_or(Bytes{})};
}

void refuse_other_keys(const Value& document, show::FieldReader& fields) {
  const auto* record = std::get_if<Record>(&document.data());
  for (const auto& field : record == nullptr ? Record() : *record)
    if (std::find(std::begin(kKeys), std::end(kKeys), field.key) == std::end(kKeys)) fields.refuse(field.key);
}

Result<RestoreJournal> parse_journal(const Value& document, const std::string& file) {
  show::FieldReader fields(document, as_it_is(file));
  if (const auto version = fields.number("servoctl_journal", true); version && *version != kJournalVersion)
    return no_journal(message("{}: its version {} is not that of this program ({})", as_it_is(file), *version,
                              kJournalVersion));
  RestoreJournal out;
  out.checksum = fields.text("checksum", true);
  const auto node = fields.number("node", true).value_or(0);
  if (node < canopen::kFirstNode || node > canopen::kLastNode) fields.refuse("node");
  out.node = static_cast<std::uint8_t>(node);
  out.with_address = fields.flag("with_address");
  out.force = fields.flag("force");
  out.keep = fields.flag("keep");
  out.unlock = fields.flag("unlock");
  const auto* means = report::find(document, "means");
  const auto* list = means == nullptr ? nullptr : std::get_if<List>(&means->data());
  if (list == nullptr) fields.refuse("means");
  for (const auto& record : list == nullptr ? List() : *list) out.means.push_back(read_mean(record, fields));
  const auto seal = fields.text("seal", true);
  refuse_other_keys(document, fields);
  if (fields.error()) return no_journal(*fields.error());
  if (seal != seal_of(out))
    return no_journal(
        message("{}: its seal does not match: the file was changed after it was written", as_it_is(file)));
  return out;
}

/// Whether the family writes the object for the sake of other writes, and knows the value.
Result<void> check_mean(const drive::Profile& profile, std::uint8_t node, ObjectAddress object,
                        const Bytes& bytes) {
  const auto means = drive::means_of_writing(profile);
  if (std::none_of(means.begin(), means.end(), [&](const auto& mean) { return mean.first == object; }))
    return fail(Errc::file, message("{} neither chooses a memory nor opens a lock of {}",
                                    as_it_is(to_string(object)), as_it_is(profile.family)));
  const auto meaning = drive::fitted(drive::meaning(drive::target_at(&profile, object), node), bytes.size());
  const auto value = od::decode(meaning.type, bytes);
  if (!value) return fail(value.error());
  return drive::check_limits(meaning, *value);
}

Result<void> check_means(const drive::Profile& profile, const RestoreJournal& journal,
                         const std::string& file) {
  std::set<ObjectAddress> seen;
  for (const auto& [object, bytes] : journal.means) {
    const bool twice = !seen.insert(object).second;
    const auto known = check_mean(profile, journal.node, object, bytes);
    if (twice || !known)
      return no_journal(message("{}: {}: {}", as_it_is(file), as_it_is(to_string(object)),
                                twice ? std::string("appears twice") : known.error().message));
  }
  return {};
}

/// Memory switch and password as they are now, unless the journal has them.
Result<void> read_means(const show::Desk& desk, RestoreJournal& journal) {
  if (!journal.means.empty()) return {};
  for (const auto& mean : drive::means_of_writing(*desk.profile)) {
    const auto value = desk.session->upload(journal.node, mean.first);
    if (value) journal.means.emplace_back(mean.first, *value);
    if (!value && value.error().code != Errc::sdo_abort) return fail(value.error());
  }
  return {};
}

}  // namespace

bool worked_in_ram(const drive::Profile& profile, const RestoreJournal& journal) {
  const auto& rules = profile.rules.store;
  if (rules.flash_switch.empty() || !rules.to_flash) return false;
  const auto flash = session::setting_write(profile, journal.node, {rules.flash_switch, *rules.to_flash});
  return flash && std::any_of(journal.means.begin(), journal.means.end(), [&](const auto& mean) {
           return mean.first == flash->object && mean.second != *flash->data;
         });
}

std::filesystem::path journal_of(const std::filesystem::path& before) { return before.string() + ".journal"; }

Result<std::optional<RestoreJournal>> read_journal(const show::Desk& desk,
                                                   const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::optional<RestoreJournal>();
  const auto text = read_file(path, kMostBytes);
  if (!text) return fail(text.error());
  const auto document = report::parse_json(*text, path.string());
  if (!document) return no_journal(document.error().message);
  auto journal = parse_journal(*document, path.string());
  if (!journal) return fail(journal.error());
  if (const auto fits = check_means(*desk.profile, *journal, path.string()); !fits) return fail(fits.error());
  return std::optional(std::move(*journal));
}

Result<void> write_journal(const std::filesystem::path& path, const RestoreJournal& journal) {
  auto document = body_of(journal);
  document.push_back({"seal", seal_of(journal)});
  return write_file_atomically(path, report::to_json(document) + "\n");
}

Result<void> note_before(const show::Desk& desk, const std::filesystem::path& before,
                         const session::Snapshot& snapshot, RestoreJournal journal) {
  if (const auto read = read_means(desk, journal); !read) return read;
  const auto saved = write_file_atomically(before, backup_text(desk, make_backup(desk, snapshot)));
  return saved ? write_journal(journal_of(before), journal) : saved;
}

Result<void> note_journal(const show::Desk& desk, const std::filesystem::path& before,
                          RestoreJournal journal) {
  const auto read = read_means(desk, journal);
  return read ? write_journal(journal_of(before), journal) : read;
}

Result<void> put_means_back(session::Session& session, const RestoreJournal& journal) {
  for (const auto& [object, bytes] : journal.means) {
    const auto present = session.upload(journal.node, object);
    if (!present) return fail(present.error());
    if (*present == bytes) continue;
    if (const auto written = session.download(journal.node, object, bytes); !written) return written;
  }
  return {};
}

}  // namespace servoctl::settings
