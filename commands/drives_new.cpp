#include <fmt/format.h>
#include <iterator>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/signal_wait.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "drive/family_files.hpp"
#include "drive/file_identity.hpp"
#include "drive/new_family.hpp"
#include "drive/standard_objects.hpp"
#include "od/data_sheet.hpp"
#include "session/scan.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kDrivesNewParameters[] = {
    {.name = "name", .help = "the name of the new family: p10", .required = true},
    {.name = "--from",
     .help = "its data sheet: an EDS, DCF or ESI file",
     .kind = Kind::file,
     .required = true},
    {.name = "--params", .help = "a table of its panel parameters (CSV)", .kind = Kind::file},
    {.name = "--faults", .help = "a table of its faults and warnings (CSV)", .kind = Kind::file},
};

Result<void> refuse_known(const Context& context, std::string_view name) {
  if (const auto fits = drive::check_family_name(name); !fits) return fits;
  const auto families = drive::find_families(context.drive_folders);
  const auto* known = drive::find_family(families, name);
  if (known == nullptr) return {};
  return fail(Errc::usage, message("the family {} exists", known->name),
              "choose another name; servoctl overwrites no family");
}

/// Of several errors the first is the answer, and the others stand beside it.
Result<void> first_of(Context& context, std::vector<Error> errors) {
  if (errors.empty()) return {};
  context.errors.insert(context.errors.end(), std::next(errors.begin()), errors.end());
  return fail(std::move(errors.front()));
}

/// The table in the file, for the family; nothing where the option is missing.
Result<drive::ConvertedTable> table_of(Context& context, const Arguments& arguments, std::string_view option,
                                       const od::Dictionary& dictionary, std::vector<Error>& errors) {
  if (!arguments.has(option)) return drive::ConvertedTable();
  const std::string path(arguments.text(option));
  const auto bytes = read_file(path);
  if (!bytes) return fail(bytes.error());
  auto out = option == "--params" ? drive::convert_parameters(*bytes, path, dictionary, errors)
                                  : drive::convert_faults(*bytes, path, errors);
  std::move(out.notices.begin(), out.notices.end(), std::back_inserter(context.notices));
  return out;
}

tl::unexpected<Error> one_device_needed() {
  return fail(Errc::usage, "a family is made from a file with one device",
              "save that device alone as an .xml file, without the others, and name it with --from");
}

/// The extension under which a family has its data sheet.
Result<std::string> sheet_extension(std::string_view from, const std::string& text) {
  if (!od::sheet_name(from).device.empty()) return one_device_needed();
  if (od::is_xml(text)) return ".xml";
  return lower(from).ends_with(".dcf") ? ".dcf" : ".eds";
}

/// The families that a drive with the identity of the data sheet fits as well: neither would be proven.
void tell_known_fits(Context& context, const od::EdsFile& sheet) {
  session::Identity identity;
  for (const auto& mark : drive::identity_marks(sheet)) {
    const auto value = static_cast<std::uint32_t>(mark.value);
    if (mark.object == objects::kDeviceType) identity.device_type = value;
    if (mark.object == objects::kVendorId) identity.vendor_id = value;
    if (mark.object == objects::kProductCode) identity.product_code = value;
    if (mark.object == objects::kRevision) identity.revision = value;
    if (mark.object == objects::kDeviceName) identity.device_name = mark.text;
  }
  const auto families = drive::find_families(context.drive_folders);
  for (const auto& family : families)
    if (const auto rules = drive::load_rules(family))
      for (const auto object : rules->identity_looks)
        identity.looked[object] = sheet.dictionary.find(object) != nullptr;
  std::vector<std::string> known;
  for (const auto& guess : session::guess_families(identity, families))
    if (!guess.generic) known.push_back(guess.family);
  if (!known.empty())
    context.notices.push_back(message(
        "the identity in the data sheet fits {} as well: a match proves neither family, and commands that write "
        "or move need -d",
        NameList{known}));
}

/// Between the steps: the first three read files of any size, the last one writes.
Result<void> go_on(unsigned signals_before) {
  if (signals_noted() == signals_before) return {};
  return fail(Errc::interrupted, "interrupted", "nothing was written");
}

struct Made {
  drive::NewFamily family;
  std::size_t entries = 0;
  std::size_t parameters = 0;
  std::size_t faults = 0;
};

Result<Made> make_family(Context& context, const Arguments& arguments) {
  const auto signals = signals_noted();
  Made out;
  out.family.name = arguments.text("name");
  const std::string from(arguments.text("--from"));
  const auto text = od::read_sheet_file(from);
  if (!text) return fail(text.error());
  const auto extension = sheet_extension(from, *text);
  if (!extension) return fail(extension.error());
  const auto sheet = od::read_data_sheet(*text, from);
  if (!sheet && sheet.error().code == Errc::usage) return one_device_needed();
  if (!sheet) return fail(sheet.error());
  if (const auto on = go_on(signals); !on) return fail(on.error());
  std::vector<Error> errors;
  const auto params = table_of(context, arguments, "--params", sheet->dictionary, errors);
  if (!params) return fail(params.error());
  const auto faults = table_of(context, arguments, "--faults", sheet->dictionary, errors);
  if (!faults) return fail(faults.error());
  if (const auto on = go_on(signals); !on) return fail(on.error());
  if (const auto sound = first_of(context, std::move(errors)); !sound) return fail(sound.error());
  const auto& name = out.family.name;
  const auto source = std::filesystem::path(from).filename().string();
  out.family.files.emplace_back(name + ".toml", drive::rules_of_sheet(*sheet, source, out.family));
  out.family.files.emplace_back(name + *extension, *text);
  if (!params->csv.empty()) out.family.files.emplace_back(name + ".params.csv", params->csv);
  if (!faults->csv.empty()) out.family.files.emplace_back(name + ".faults.csv", faults->csv);
  tell_known_fits(context, *sheet);
  out.entries = sheet->dictionary.entry_count();
  out.parameters = params->rows;
  out.faults = faults->rows;
  if (const auto findings = sheet->diagnostics.size(); findings > 0)
    context.notices.push_back(message("{}: {} errors, {} warnings; `eds check` explains them", as_it_is(from),
                                      sheet->error_count(), sheet->warning_count()));
  return out;
}

report::List list_of(std::span<const std::string> words) {
  report::List out;
  for (const auto& word : words) out.emplace_back(word);
  return out;
}

Result<report::Value> run_drives_new(Context& context, const Arguments& arguments) {
  if (const auto free = refuse_known(context, arguments.text("name")); !free) return fail(free.error());
  const auto made = make_family(context, arguments);
  if (!made) return fail(made.error());
  const auto folder = drive::own_families_folder();
  if (!folder) return fail(folder.error());
  const auto& family = made->family;
  const auto make = context.dry_run ? drive::try_family : drive::write_family;
  const auto place = make(family, *folder, context.drive_folders);
  if (!place) return fail(place.error());
  if (context.dry_run)
    context.notices.push_back(message("dry run: {} is not written", as_it_is(place->string())));
  std::vector<std::string> files;
  for (const auto& [name, content] : family.files) files.push_back(name);
  return report::Value(report::Record{
      {"family", family.name},
      {"folder", place->string()},
      {"files", list_of(files)},
      {"entries", made->entries},
      {"parameters", made->parameters},
      {"faults", made->faults},
      {"identity", family.identity.empty() ? report::Value() : report::Value(list_of(family.identity))},
      {"open", list_of(family.open), report::Show::everywhere, "to decide"}});
}

constexpr Example kDrivesNewExamples[] = {
    {"drives new p10 --from drive.eds", "its data sheet alone"},
    {"drives new p10 --from gripper.eds --params params.csv --faults faults.csv",
     "with the tables of the manual"},
};

}  // namespace

extern const Command kDrivesNew;
const Command kDrivesNew{
    .path = "drives new",
    .summary = "Make a drive family from its data sheet and tables",
    .details =
        "Writes the family into ~/.config/servoctl/drives/NAME: the data sheet, the tables, and rules with a comment "
        "at each key that a person has to decide. All files are written, or none; an existing family is never "
        "overwritten. What is written passes `drives check`. Tables are read as spreadsheets save them: English or "
        "Chinese headings in any order, commas, semicolons or tabs, UTF-8 or GBK. --params needs a column with the "
        "parameter numbers (id, No.); object, type, access, default and range that it does not have come from the "
        "data sheet, and where type, access or a wider limit contradict it, the data sheet is used, with a notice. If "
        "a parameter has a scale, a wider limit or another default is an error. --faults needs a column with names; "
        "codes of 603Fh are written 0x8611 or 8611h. Nothing is guessed: a cell that can be read in two ways is an "
        "error with its line and what to write; a column that is not understood is left out with a notice. The rules "
        "are never `certain`: a person decides that. --dry-run checks all this and writes nothing.",
    .parameters = kDrivesNewParameters,
    .examples = kDrivesNewExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_drives_new,
};

}  // namespace servoctl::commands
