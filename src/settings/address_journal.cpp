#include "settings/address_journal.hpp"

#include "base/checksum.hpp"
#include "base/file.hpp"
#include "canopen/node_id.hpp"
#include "report/value.hpp"
#include "show/field_reader.hpp"
#include "show/identity.hpp"

namespace servoctl::settings {
namespace {

using report::List;
using report::Record;
using report::Value;

constexpr std::uint64_t kAddressJournalVersion = 1;
constexpr std::uintmax_t kMostBytesOfJournal = 1U << 20U;

Record address_body(const AddressJournal& journal) {
  List steps;
  for (const auto& step : journal.steps)
    steps.emplace_back(Record{{"row", step.row}, {"from", step.from}, {"to", step.to}});
  List drives;
  for (std::size_t i = 0; i < journal.drives.size(); ++i) {
    const auto& drive = journal.drives[i];
    Record record{{"node", drive.node}, {"identity", show::identity_record(drive)}};
    // A journal of before has none.
    if (i < journal.families.size() && !journal.families[i].empty())
      record.push_back({"family", journal.families[i]});
    drives.emplace_back(std::move(record));
  }
  return {{"servoctl_address_plan", kAddressJournalVersion},
          {"checksum", journal.checksum},
          {"done", journal.done},
          {"begun", journal.begun},
          {"steps", std::move(steps)},
          {"drives", std::move(drives)}};
}

tl::unexpected<Error> no_address_journal(Message message) {
  return fail(Errc::file, std::move(message),
              "it tells how far an interrupted plan came; `scan` shows where the drives are, and without the "
              "journal a plan of what is left can be made anew");
}

const List& list_of(const Value& document, std::string_view key, show::FieldReader& fields) {
  static const List kNone;
  const auto* value = report::find(document, key);
  const auto* list = value == nullptr ? nullptr : std::get_if<List>(&value->data());
  if (list == nullptr) fields.refuse(key);
  return list == nullptr ? kNone : *list;
}

std::uint8_t node_in(show::FieldReader& record, std::string_view key) {
  const auto number = record.number(key, true).value_or(0);
  if (number < canopen::kFirstNode || number > canopen::kLastNode) record.refuse(key);
  return static_cast<std::uint8_t>(number);
}

AddressStep read_step(const Value& record, std::size_t rows, show::FieldReader& fields) {
  show::FieldReader step(record, "steps");
  AddressStep out{static_cast<std::size_t>(step.number("row", true).value_or(0)), node_in(step, "from"),
                  node_in(step, "to")};
  if (step.error() || out.row >= rows) fields.refuse("steps");
  return out;
}

session::Identity read_drive(const Value& record, show::FieldReader& fields) {
  show::FieldReader drive(record, "drives");
  const auto node = node_in(drive, "node");
  const auto* value = report::find(record, "identity");
  auto identity = value == nullptr ? std::nullopt : show::identity_of(*value, node);
  if (drive.error() || !identity) fields.refuse("drives");
  return std::move(identity).value_or(session::Identity{});
}

}  // namespace

std::filesystem::path address_journal_of(const std::filesystem::path& plan) {
  return plan.string() + ".journal";
}

Result<std::optional<AddressJournal>> read_address_journal(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::optional<AddressJournal>();
  const auto text = read_file(path, kMostBytesOfJournal);
  if (!text) return fail(text.error());
  const auto document = report::parse_json(*text, path.string());
  if (!document) return no_address_journal(document.error().message);
  show::FieldReader fields(*document, as_it_is(path.string()));
  if (fields.number("servoctl_address_plan", true).value_or(0) != kAddressJournalVersion)
    fields.refuse("servoctl_address_plan");
  AddressJournal out;
  out.checksum = fields.text("checksum", true);
  out.done = static_cast<std::size_t>(fields.number("done", true).value_or(0));
  out.begun = fields.flag("begun");
  for (const auto& record : list_of(*document, "drives", fields)) {
    out.drives.push_back(read_drive(record, fields));
    out.families.push_back(show::FieldReader(record, "drives").text("family", false));
  }
  for (const auto& record : list_of(*document, "steps", fields))
    out.steps.push_back(read_step(record, out.drives.size(), fields));
  if (out.done > out.steps.size()) fields.refuse("done");
  const auto seal = fields.text("seal", true);
  if (fields.error()) return no_address_journal(*fields.error());
  if (seal != checksum_of(report::to_json(address_body(out))))
    return no_address_journal(message(
        "{}: its seal does not match: the file was changed after it was written", as_it_is(path.string())));
  return std::optional(std::move(out));
}

Result<void> write_address_journal(const std::filesystem::path& path, const AddressJournal& journal) {
  auto document = address_body(journal);
  document.push_back({"seal", checksum_of(report::to_json(address_body(journal)))});
  return write_file_atomically(path, report::to_json(document) + "\n");
}

}  // namespace servoctl::settings
