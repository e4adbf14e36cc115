#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/file.hpp"
#include "base/text.hpp"
#include "cabinet/cabinet.hpp"
#include "command/command.hpp"
#include "command/output_form.hpp"
#include "command/registry.hpp"
#include "trial/comm_trial.hpp"
#include "trial/drive_report.hpp"
#include "trial/earlier_tests.hpp"
#include "trial/report_head.hpp"
#include "trial/verdict.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::List;
using report::Record;
using report::Show;
using report::TestResult;
using report::Value;

constexpr Parameter kReportParameters[] = {
    {.name = "file", .help = "FILE.html, or FILE.json for programs", .kind = Kind::file},
    {.name = "--output",
     .help = "the file, like FILE; or the output format: text, json, jsonl",
     .kind = Kind::file,
     .short_name = "-o"},
    {.name = "--title", .help = "title of the report (default: Commissioning report)", .kind = Kind::text},
    {.name = "--customer", .help = "for whom the report is made", .kind = Kind::text},
    {.name = "--machine", .help = "the machine that the drives belong to", .kind = Kind::text},
    {.name = "--operator", .help = "who commissioned it", .kind = Kind::text},
    {.name = "--logo",
     .help = "picture on the first page: PNG, JPEG or SVG, up to 1 MiB",
     .kind = Kind::file},
    {.name = "--signatures",
     .help = "who signs at the end, with commas between; none (default with --customer: Commissioning "
             "engineer,Customer)",
     .kind = Kind::text},
    {.name = "--tests",
     .help = "results of earlier tests (test … --json >FILE); may be repeated",
     .kind = Kind::file,
     .repeats = true},
};

enum class Form : std::uint8_t { html, json };

Result<Form> form_of(const std::filesystem::path& file) {
  const auto extension = lower(file.extension().string());
  if (extension == ".html" || extension == ".htm") return Form::html;
  if (extension == ".json") return Form::json;
  return fail(Errc::usage, fmt::format("'{}' is not a report file name", file.string()),
              "use .html for people or .json for programs");
}

/// `report FILE` and `report -o FILE` are the same.
Result<std::filesystem::path> file_of(const Arguments& arguments) {
  const auto output = arguments.text("--output");
  const bool named = arguments.has("--output") && !is_output_form(output);
  if (named && arguments.has("file"))
    return fail(Errc::usage,
                fmt::format("'{}' and '{}': one file at a time", arguments.text("file"), output));
  if (!named && !arguments.has("file"))
    return fail(Errc::usage, "which file?", "`report FILE.html` for people, `report FILE.json` for programs");
  return std::filesystem::path(named ? output : arguments.text("file"));
}

/// What one command answers for one drive, without what the heading says already.
Value of_one_drive(Value value) {
  auto* list = std::get_if<List>(&value.data());
  if (list == nullptr) return value;
  if (list->empty()) return {};
  auto first = list->front();
  if (auto* record = std::get_if<Record>(&first.data()))
    std::erase_if(*record, [](const report::Field& field) { return field.key == "node"; });
  return first;
}

/// Asks the nodes of the context, tests their communication, and adds the results of earlier tests of theirs.
/// Parts that a drive refuses carry the reason; a node without answer is one of the errors of the context,
/// and so is a test that failed. Errc::bus or interrupted when it could not be done, timeout when no node
/// answers.
class Collection {
 public:
  Collection(Context& context, const std::vector<TestResult>& earlier)
      : context_(&context), earlier_(&earlier) {}

  Result<trial::Report> make(trial::ReportCover cover) {
    out_.cover = std::move(cover);
    if (out_.cover.title.empty()) out_.cover.title = say("Commissioning report", "调试报告");
    auto bus = part("bus", say("Bus", "总线"), "scan", {}, {});
    if (!bus) return fail(bus.error());
    out_.bus = std::move(*bus);
    out_.link = trial::link_record(*context_);
    for (const auto node : context_->nodes) {
      auto drive = of_drive(node);
      if (!drive) return fail(drive.error());
      out_.drives.push_back(std::move(*drive));
    }
    // Of the whole command now: said once.
    if (answered_ == 0) return fail(std::exchange(context_->errors, {}).front());
    out_.head = trial::report_head(*context_, out_.cover, tests_);
    return std::move(out_);
  }

 private:
  std::string say(std::string_view english, std::string_view chinese) const {
    return trial::say(*context_, english, chinese);
  }

  /// Runs a command for one drive (for the bus where there is none). A difference or a fault is what a report
  /// is there to tell: no error of it.
  Result<trial::ReportPart> part(std::string id, std::string title, std::string_view command,
                                 std::optional<std::uint8_t> node, const Arguments& arguments) {
    Context inner = *context_;
    inner.errors.clear();
    inner.notices.clear();
    inner.nodes.clear();
    if (node) inner.nodes.push_back(*node);
    auto result = find_command(command)->run(inner, arguments);
    if (!result) inner.errors.push_back(result.error());
    trial::ReportPart out{std::move(id), std::move(title), {}, std::move(inner.notices)};
    for (auto& error : inner.errors) {
      if (error.code == Errc::bus || error.code == Errc::interrupted) return fail(std::move(error));
      if (error.code == Errc::negative) continue;
      out.remarks.push_back(error.message);
      context_->errors.push_back(std::move(error));
    }
    if (result) out.value = node ? of_one_drive(std::move(*result)) : std::move(*result);
    return out;
  }

  std::string title_of(std::uint8_t node) const {
    for (const auto* axis : context_->axes)
      if (axis->node == node)
        return say(fmt::format("{} (node {})", axis->name, node),
                   fmt::format("{}（节点 {}）", axis->name, node));
    return say(fmt::format("Node {}", node), fmt::format("节点 {}", node));
  }

  Result<trial::DriveReport> of_drive(std::uint8_t node) {
    struct Wanted {
      std::string_view id;
      std::string_view title;
      std::string_view title_zh;
      std::string_view command;
    };
    static constexpr Wanted kParts[] = {
        {"identity", "Identity", "标识", "info"},
        {"state", "State", "状态", "status"},
        {"faults", "Faults", "故障", "fault show"},
        {"settings", "Settings that differ from factory values", "与出厂值不同的设置", "verify"},
        {"pdos", "Process data (PDO)", "过程数据 (PDO)", "pdo show"},
    };
    trial::DriveReport out{node, title_of(node), {}, {}};
    Arguments factory;
    factory.add("file", "factory");
    for (const auto& wanted : kParts) {
      auto one =
          part(std::string(wanted.id), say(wanted.title, wanted.title_zh), wanted.command, node, factory);
      if (!one) return fail(one.error());
      const bool silent = one->value.is_null() && wanted.id == "identity";
      out.parts.push_back(std::move(*one));
      if (silent) return out;  // Each further part would only wait for it.
    }
    ++answered_;
    if (const auto tested = add_tests(node, out); !tested) return fail(tested.error());
    return out;
  }

  /// Of several tests of the communication the last one given counts.
  bool is_superseded(const TestResult& result) const {
    if (result.test != trial::kCommTestName) return false;
    const auto last = std::find_if(earlier_->rbegin(), earlier_->rend(), [&](const TestResult& other) {
      return other.test == result.test && other.node == result.node;
    });
    return &*last != &result;
  }

  Result<void> add_tests(std::uint8_t node, trial::DriveReport& drive) {
    const bool tested = std::any_of(earlier_->begin(), earlier_->end(), [&](const TestResult& result) {
      return result.node == node && result.test == trial::kCommTestName;
    });
    if (!tested) {
      auto comm = trial::test_communication(*context_, node, {});
      if (!comm) return fail(comm.error());
      comm->origin = trial::origin_of(*context_, node);
      drive.tests.push_back(std::move(*comm));
    }
    for (const auto& result : *earlier_)
      if (result.node == node && !is_superseded(result)) drive.tests.push_back(result);
    for (const auto& result : drive.tests) {
      ++tests_.all;
      if (passed(result)) continue;
      ++tests_.failed;
      context_->errors.push_back(trial::failure(result));
    }
    return {};
  }

  Context* context_;
  const std::vector<TestResult>* earlier_;
  trial::Report out_;
  std::size_t answered_ = 0;
  trial::TestCount tests_;
};

Result<trial::ReportCover> cover_of(const Context& context, const Arguments& arguments) {
  return trial::read_cover(context, {.title = arguments.text("--title"),
                                     .customer = arguments.text("--customer"),
                                     .machine = arguments.text("--machine"),
                                     .operator_name = arguments.text("--operator"),
                                     .logo = arguments.text("--logo"),
                                     .signatures = arguments.text("--signatures")});
}

Result<void> check_report(Context& context, const Arguments& arguments) {
  const auto file = file_of(arguments);
  if (!file) return fail(file.error());
  if (const auto form = form_of(*file); !form) return fail(form.error());
  const auto cover = cover_of(context, arguments);
  return cover ? Result<void>() : fail(cover.error());
}

Result<Value> run_report(Context& context, const Arguments& arguments) {
  const auto named = file_of(arguments);
  if (!named) return fail(named.error());
  const auto& file = *named;
  const auto form = form_of(file);
  if (!form) return fail(form.error());
  std::vector<report::TestResult> earlier;
  for (const auto& tests : arguments.all("--tests")) {
    auto read = trial::read_tests(tests);
    if (!read) return fail(read.error());
    for (auto& result : *read) earlier.push_back(std::move(result));
  }
  for (const auto& result : earlier)
    if (std::find(context.nodes.begin(), context.nodes.end(), result.node) == context.nodes.end())
      context.notices.push_back(fmt::format("`test {}` of node {} is not in the report: add the node to -n",
                                            result.test, result.node));
  if (const auto same = trial::check_tested(context, earlier); !same) return fail(same.error());
  auto cover = cover_of(context, arguments);
  if (!cover) return fail(cover.error());
  const auto made = Collection(context, earlier).make(std::move(*cover));
  if (!made) return fail(made.error());
  const auto text =
      *form == Form::html ? trial::report_page(context, *made) : trial::report_json(context, *made);
  const auto written = write_file_atomically(file, text);
  if (!written) return fail(written.error());
  report::Record out{{"file", file.string()}, {"nodes", made->drives.size()}};
  for (const auto& field : made->head)
    if (field.key.starts_with("tests")) out.push_back(field);
  return Value(std::move(out));
}

constexpr Example kReportExamples[] = {
    {"report lift.html -n 1 -d gsd600 --title \"Lift, cell 3\"", "a page to print and to hand over"},
    {"report lift.html --tests test.json -n 1 -d gsd600", "with the tests that were made before"},
    {"report lift.html --lang zh -n 1 -d gsd600", "in Chinese"},
};

}  // namespace

extern const Command kReport;
const Command kReport{
    .path = "report",
    .summary = "Write a commissioning report: one page, or JSON",
    .details =
        "Identity and firmware, state, faults and their history, settings not at factory value, PDOs, other "
        "nodes on the bus, and a communication test; with --tests also results and plots of earlier tests, "
        "refused if they are from another drive. The page needs no network and prints on A4, each drive on a "
        "new sheet; --lang zh makes it Chinese. --customer, --machine, --operator and --logo stand on the first "
        "page, lines to be signed (--signatures) at the end; the picture is part of the file. Moves nothing and "
        "changes nothing. One report is of one bus and one family. The file is written whole or not at all; exit "
        "code 1 when a test in it failed.",
    .parameters = kReportParameters,
    .examples = kReportExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .family = FamilyCheck::always,
    .run = run_report,
    .check = check_report,
    .goes_on = true,  // One file is of one bus and family: the second would replace the first.
};

}  // namespace servoctl::commands
