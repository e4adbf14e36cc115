#include <algorithm>

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "base/standard_input.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "od/data_sheet.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;

constexpr Parameter kEdsCheckParameters[] = {
    {.name = "file",
     .help = "an EDS, DCF or ESI file; - for standard input",
     .kind = Kind::file,
     .required = true,
     .many = true},
};

constexpr std::string_view kStandardInput = "-";

Result<std::string> text_of(const Context& context, const std::string& path) {
  if (path != kStandardInput) return od::read_sheet_file(path);
  if (context.stays_open)
    return fail(Errc::usage, "standard input contains the command lines, and no file for this one",
                "name a file");
  return standard_input().take_rest(od::kMostEsiBytes);
}

report::Table findings_of(const od::EdsFile& file) {
  report::Table out;
  out.columns = {
      {"line"},  {"column", "", Show::json}, {"section"}, {"key"}, {"severity"}, {"rule"}, {"message"},
      {"remedy"}};
  for (const auto& finding : file.diagnostics)
    out.rows.push_back({finding.line, finding.column, report::text_or_null(finding.section),
                        report::text_or_null(finding.key),
                        finding.severity == od::Severity::error ? "error" : "warning", finding.rule,
                        finding.message, finding.remedy});
  return out;
}

/// `DC (DC-Synchron)`, as the file calls it.
std::string modes_of(const od::EsiLayout& layout) {
  std::string out;
  for (const auto& mode : layout.modes)
    append(out, mode.description.empty() ? mode.name : formatted("{} ({})", mode.name, mode.description));
  return out;
}

/// What an ESI says beside the objects.
report::Record ethercat_record(const od::EsiFile& esi) {
  const auto& layout = esi.layout;
  const auto pdos = [&](PdoDirection direction) {
    return std::count_if(layout.pdos.begin(), layout.pdos.end(),
                         [&](const od::EsiPdo& pdo) { return pdo.direction == direction; });
  };
  const auto size = [&](od::EsiSyncManager::Use use) {
    const auto* manager = layout.find(use);
    return manager == nullptr || manager->size == 0 ? report::Value() : report::Value(manager->size);
  };
  using Use = od::EsiSyncManager::Use;
  return {{"type", report::text_or_null(esi.device.type)},
          {"group", report::text_or_null(esi.device.group)},
          {"product_code", report::Hex{esi.device.product_code, 8}, Show::everywhere, "product code"},
          {"revision", report::Hex{esi.device.revision, 8}},
          {"coe", layout.coe},
          {"sdo_info", layout.sdo_info, Show::everywhere, "SDO information"},
          {"complete_access", layout.complete_access, Show::everywhere, "complete access"},
          {"mailbox_out", size(Use::mailbox_out), Show::everywhere, "mailbox out"},
          {"mailbox_in", size(Use::mailbox_in), Show::everywhere, "mailbox in"},
          {"rx_pdos", pdos(PdoDirection::receive), Show::everywhere, "RxPDOs"},
          {"tx_pdos", pdos(PdoDirection::transmit), Show::everywhere, "TxPDOs"},
          {"synchronisation", report::text_or_null(modes_of(layout))}};
}

report::Record finding_record(const std::string& path, const od::EdsFile& file) {
  auto findings = findings_of(file);
  return {{"file", path},
          {"product", report::text_or_null(file.device.product_name)},
          {"vendor", report::text_or_null(file.device.vendor_name)},
          {"objects", file.dictionary.objects().size()},
          {"entries", file.dictionary.entry_count()},
          {"errors", file.error_count()},
          {"warnings", file.warning_count()},
          {"findings", findings.rows.empty() ? report::Value() : report::Value(findings), Show::text},
          {"findings", std::move(findings), Show::json},
          {"error", report::Value(), Show::json}};
}

/// Of a file that cannot be used: its error stands in the list as well, so that no file is missing there.
report::Record finding_record(const std::string& path, const Error& error, bool alone) {
  const auto show = alone ? Show::json : Show::everywhere;
  report::Record out{{"file", path, show}};
  for (const auto* key : {"product", "vendor", "objects", "entries", "errors", "warnings"})
    out.push_back({key, report::Value(), Show::json});
  out.push_back({"findings", report::List{}, Show::json});
  if (!alone) out.push_back({"error", error.message.text(), Show::text});
  out.push_back({"error", show::error_record(error), Show::json});
  return out;
}

Error errors_error(const std::string& path, std::size_t errors) {
  return make_error(Errc::negative, message("{}: {} error{}", as_it_is(path), errors, plural(errors)),
                    "the remedy column says what to change; everything else in the file is usable");
}

/// The findings of a file, one record for each device it describes; an error stands in the list as well.
class Check {
 public:
  Check(Context& context, bool alone) : context_(&context), alone_(alone) {}

  void file(const std::string& word) {
    const auto text = text_of(*context_, word);
    if (!text) return refuse(word, text.error());
    if (od::is_xml(*text)) return esi(word, *text);
    const auto file = od::read_eds(*text, word);
    if (!file) return refuse(word, file.error());
    count_errors(word, *file);
    out_.emplace_back(finding_record(word, *file));
  }

  report::List take() { return std::move(out_); }

 private:
  void esi(const std::string& word, const std::string& text) {
    const auto name = od::sheet_name(word);
    if (name.device.empty()) {
      const auto all = od::read_all_esi(text, name.path);
      if (!all) return refuse(word, all.error());
      for (const auto& file : *all)
        add(file.devices == 1 ? word : formatted("{}#{}", name.path, file.number), file);
      return;
    }
    const auto file = od::read_esi(text, name.path, name.device);
    if (!file) return refuse(word, file.error());
    add(word, *file);
  }

  void add(const std::string& word, const od::EsiFile& file) {
    count_errors(word, file.sheet);
    auto record = finding_record(word, file.sheet);
    const auto ethercat = ethercat_record(file);
    record.insert(record.begin() + 3, ethercat.begin(), ethercat.end());
    out_.emplace_back(std::move(record));
  }

  void refuse(const std::string& word, const Error& error) {
    context_->errors.push_back(error);
    out_.emplace_back(finding_record(word, error, alone_));
  }

  void count_errors(const std::string& word, const od::EdsFile& file) {
    if (const auto errors = file.error_count(); errors > 0)
      context_->errors.push_back(errors_error(word, errors));
  }

  Context* context_;
  bool alone_ = false;
  report::List out_;
};

Result<report::Value> run_eds_check(Context& context, const Arguments& arguments) {
  const auto words = arguments.all("file");
  Check check(context, words.size() == 1);
  for (const auto& word : words) check.file(word);
  // The first error makes the exit code: the worst one, in whatever order the files are named.
  std::stable_sort(context.errors.begin(), context.errors.end(),
                   [](const Error& a, const Error& b) { return exit_code(a.code) > exit_code(b.code); });
  return report::Value(check.take());
}

constexpr Example kEdsCheckExamples[] = {
    {"eds check drive.eds", "one file, with what to change in it"},
    {"eds check drive.eds device.xml#2", "several; of the ESI the second device"},
};

}  // namespace

extern const Command kEdsCheck;
const Command kEdsCheck{
    .path = "eds check",
    .summary = "Check EDS, DCF and ESI files",
    .details =
        "EDS and DCF are held against CiA 306, ESI files (XML, of EtherCAT devices) against ETG.2000. "
        "Every finding gives line, section, key, rule and remedy, and what is used instead. Exit code 1 if "
        "there are errors; warnings alone are fine. A file that cannot be read is listed with its error; of "
        "several files the worst sets the exit code. Of an ESI with several devices each is checked: FILE.xml#2 is "
        "the second alone, and FILE.xml#NAME the one of that name. `-` reads standard input to its end: in a pipe of "
        "command lines, what follows this line.",
    .parameters = kEdsCheckParameters,
    .examples = kEdsCheckExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_eds_check,
};

}  // namespace servoctl::commands
