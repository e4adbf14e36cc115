#include <cctype>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "od/data_sheet.hpp"
#include "od/dcf.hpp"
#include "od/eds_writer.hpp"
#include "settings/backup_formats.hpp"

namespace servoctl::settings {
namespace {

/// `500 kbit/s`, `1 Mbit/s`: the label of the family's bitrate parameter, in kbit/s; or its value, where that
/// is the bitrate itself.
std::optional<std::uint32_t> kbps_of(const drive::Profile& profile, const Backup& backup) {
  const auto place = drive::place_of(profile, profile.rules.nmt.bitrate);
  if (!place) return std::nullopt;
  const auto meaning = drive::meaning(drive::target_at(&profile, *place), 0);
  for (const auto& entry : backup.entries) {
    if (entry.object != *place || !entry.bytes) continue;
    const auto code = load_le(*entry.bytes);
    if (meaning.unit == "kbit/s") return static_cast<std::uint32_t>(code);
    if (meaning.labels == nullptr) return std::nullopt;
    for (const auto& label : *meaning.labels) {
      if (static_cast<std::uint64_t>(label.value) != code) continue;
      const auto space = label.label.find(' ');
      const auto number = parse_digits(std::string_view(label.label).substr(0, space), 10);
      if (!number || space == std::string::npos) return std::nullopt;
      return static_cast<std::uint32_t>(*number * (label.label[space + 1] == 'M' ? 1000 : 1));
    }
  }
  return std::nullopt;
}

void set_time(std::string_view iso, od::DcfSettings& out) {
  const auto time = od::eds_time(iso);
  out.date = time.date;
  out.time = time.time;
}

/// The values of the text, read again.
std::map<ObjectAddress, Bytes> values_in(const std::string& text, const std::string& file_name,
                                         std::uint8_t node) {
  std::map<ObjectAddress, Bytes> out;
  const auto dcf = od::read_dcf(text, file_name);
  for (const auto& value : dcf ? dcf->values : std::vector<od::DcfValue>())
    if (auto bytes = od::encode(value.type, value.value.for_node(node)))
      out.emplace(value.object, std::move(*bytes));
  return out;
}

/// Whether a line of a DCF can carry the value: text with a line break in it would be another line.
bool fits_a_dcf(const od::Value& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text == nullptr || fits_a_line(*text);
}

std::string missing(const drive::Profile& profile, const Backup& backup, const Backup::Entry& entry) {
  const auto range = range_missed(profile, backup.identity.node, entry.object, *entry.bytes);
  return formatted("{} {} {} ({}): use JSON to keep it", to_string(entry.object), entry.name,
                   range.empty() ? std::string("cannot be stored in a DCF unchanged")
                                 : formatted("is outside of its limits {} and not in the DCF", range),
                   entry.bytes->empty() ? std::string("\"\"") : to_hex(*entry.bytes));
}

}  // namespace

Result<std::string> dcf_text(const drive::Profile& profile, const Backup& backup,
                             const std::string& file_name, std::vector<Message>& notices) {
  if (profile.data_sheet.empty())
    return fail(Errc::usage, message("{} has no data sheet (EDS) to make a DCF of", as_it_is(profile.family)),
                "use --format json, csv or batch");
  const auto eds = od::read_sheet_file(profile.data_sheet.string());
  if (!eds) return fail(eds.error());
  if (od::is_xml(*eds))
    return fail(Errc::usage,
                message("{} is an ESI, and a DCF is made of an EDS", as_it_is(profile.data_sheet.string())),
                "use --format json, csv or batch");
  od::DcfSettings settings;
  settings.file_name = file_name;
  settings.node_id = backup.identity.node;
  settings.node_name = formatted("Node {}", backup.identity.node);
  settings.kbps = kbps_of(profile, backup);
  set_time(backup.time, settings);
  for (const auto& entry : backup.entries) {
    const auto* known = profile.dictionary.find(entry.object);
    if (!entry.bytes || known == nullptr ||
        !range_missed(profile, backup.identity.node, entry.object, *entry.bytes).empty())
      continue;
    // By the data sheet's type: the drive may have told another length.
    if (auto value = od::decode(known->type, *entry.bytes); value && fits_a_dcf(*value))
      settings.values.emplace(entry.object, std::move(*value));
  }
  auto text = od::write_dcf(*eds, settings);
  if (!text) return text;
  const auto said = values_in(*text, file_name, backup.identity.node);
  bool wrong = false;
  for (const auto& entry : backup.entries) {
    if (!entry.bytes) continue;
    const auto found = said.find(entry.object);
    if (found != said.end() && found->second == *entry.bytes) continue;
    wrong = settings.values.erase(entry.object) > 0 || wrong;
    notices.push_back(missing(profile, backup, entry));
  }
  // What would come back as another value does not stand in it.
  return wrong ? od::write_dcf(*eds, settings) : text;
}

Result<Backup> read_dcf_backup(std::string_view text, const std::string& file, std::uint8_t node) {
  auto dcf = od::read_dcf(text, file);
  if (!dcf) return fail(dcf.error());
  Backup out;
  out.identity.node = dcf->node_id;
  if (dcf->vendor_number != 0) out.identity.vendor_id = dcf->vendor_number;
  if (dcf->product_number != 0) out.identity.product_code = dcf->product_number;
  out.unusable = std::move(dcf->unusable);
  out.passed_over = std::move(dcf->passed_over);
  for (const auto& value : dcf->values) {
    Backup::Entry entry;
    entry.object = value.object;
    entry.type = value.type;
    entry.line = value.line;
    auto bytes = od::encode(value.type, value.value.for_node(dcf->node_id != 0 ? dcf->node_id : node));
    if (!bytes) {
      out.unusable.push_back(fail(Errc::file, message("{}:{}: {}: {}", as_it_is(file), value.line,
                                                      to_string(value.object), bytes.error().message))
                                 .value());
      continue;
    }
    entry.bytes = std::move(*bytes);
    out.entries.push_back(std::move(entry));
  }
  return out;
}

}  // namespace servoctl::settings
