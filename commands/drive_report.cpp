#include "commands/drive_report.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/calendar.hpp"
#include "commands/comm_test.hpp"
#include "commands/report_words.hpp"
#include "commands/verdict.hpp"
#include "session/open_bus.hpp"

namespace servoctl::commands {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::TestResult;
using report::Value;

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

class Collection {
 public:
  Collection(Context& context, const std::vector<TestResult>& earlier)
      : context_(&context), earlier_(&earlier) {}

  Result<Report> make(std::string title) {
    out_.title = title.empty() ? say("Commissioning report", "调试报告") : std::move(title);
    const auto time = utc_now_text();
    auto bus = part("bus", say("Bus", "总线"), "scan", {}, {});
    if (!bus) return tl::unexpected<Error>(bus.error());
    out_.bus = std::move(*bus);
    out_.link = link_record();
    for (const auto node : context_->nodes) {
      auto drive = of_drive(node);
      if (!drive) return tl::unexpected<Error>(drive.error());
      out_.drives.push_back(std::move(*drive));
    }
    // Of the whole command now: said once.
    if (answered_ == 0) return fail(std::exchange(context_->errors, {}).front());
    const auto& rules = context_->profile->rules;
    const auto& name = context_->chinese && !rules.name_zh.empty() ? rules.name_zh : rules.name;
    out_.head = {{"time", time, Show::everywhere, say("made at", "生成时间")},
                 {"tool", "servoctl " SERVOCTL_VERSION, Show::everywhere, say("made with", "生成工具")},
                 {"bus", context_->session->url(), Show::everywhere, say("bus", "总线")},
                 {"family", fmt::format("{} ({} {})", context_->profile->family, rules.vendor, name),
                  Show::text, say("drive family", "驱动器系列")},
                 {"family", context_->profile->family, Show::json},
                 {"tests_text", tests_text(), Show::text, say("tests", "测试")},
                 {"tests_passed", failed_ == 0, Show::json}};
    return std::move(out_);
  }

 private:
  std::string say(std::string_view english, std::string_view chinese) const {
    return commands::say(*context_, english, chinese);
  }

  std::string tests_text() const {
    const auto passed = tests_ - failed_;
    return failed_ == 0 ? say(fmt::format("{} passed", passed), fmt::format("{} 项通过", passed))
                        : say(fmt::format("{} passed, {} FAILED", passed, failed_),
                              fmt::format("{} 项通过，{} 项未通过", passed, failed_));
  }

  Value link_record() const {
    const auto link = session::link_of(context_->session->url());
    if (!link) return {};
    const auto or_null = [](const auto& value) { return value ? Value(*value) : Value(); };
    return Record{
        {"bitrate", or_null(link->bitrate), Show::everywhere, say("bitrate (bit/s)", "波特率 (bit/s)")},
        {"controller", link->health ? Value(can::name(*link->health)) : Value(), Show::everywhere,
         say("controller", "CAN 控制器")},
        {"tx_errors", or_null(link->tx_errors), Show::everywhere, say("send errors", "发送错误计数")},
        {"rx_errors", or_null(link->rx_errors), Show::everywhere, say("receive errors", "接收错误计数")}};
  }

  /// Runs a command for one drive (for the bus where there is none). A difference or a fault is what a report
  /// is there to tell: no error of it.
  Result<ReportPart> part(std::string id, std::string title, std::string_view command,
                          std::optional<std::uint8_t> node, const Arguments& arguments) {
    Context inner = *context_;
    inner.errors.clear();
    inner.notices.clear();
    inner.nodes.clear();
    if (node) inner.nodes.push_back(*node);
    auto result = find_command(command)->run(inner, arguments);
    if (!result) inner.errors.push_back(result.error());
    ReportPart out{std::move(id), std::move(title), {}, std::move(inner.notices)};
    for (auto& error : inner.errors) {
      if (error.code == Errc::bus || error.code == Errc::interrupted) return fail(std::move(error));
      if (error.code == Errc::negative) continue;
      out.remarks.push_back(error.message);
      context_->errors.push_back(std::move(error));
    }
    if (result) out.value = node ? of_one_drive(std::move(*result)) : std::move(*result);
    return out;
  }

  Result<DriveReport> of_drive(std::uint8_t node) {
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
        {"settings", "Settings that differ from the factory's", "与出厂值不同的设置", "verify"},
        {"pdos", "Process data (PDO)", "过程数据 (PDO)", "pdo show"},
    };
    DriveReport out{node, say(fmt::format("Node {}", node), fmt::format("节点 {}", node)), {}, {}};
    Arguments factory;
    factory.add("file", "factory");
    for (const auto& wanted : kParts) {
      auto one =
          part(std::string(wanted.id), say(wanted.title, wanted.title_zh), wanted.command, node, factory);
      if (!one) return tl::unexpected<Error>(one.error());
      const bool silent = one->value.is_null() && wanted.id == "identity";
      out.parts.push_back(std::move(*one));
      if (silent) return out;  // Each further part would only wait for it.
    }
    ++answered_;
    if (const auto tested = add_tests(node, out); !tested) return tl::unexpected<Error>(tested.error());
    return out;
  }

  /// Of several tests of the communication the last one given counts.
  bool is_superseded(const TestResult& result) const {
    if (result.test != kCommTestName) return false;
    const auto last = std::find_if(earlier_->rbegin(), earlier_->rend(), [&](const TestResult& other) {
      return other.test == result.test && other.node == result.node;
    });
    return &*last != &result;
  }

  Result<void> add_tests(std::uint8_t node, DriveReport& drive) {
    const bool tested = std::any_of(earlier_->begin(), earlier_->end(), [&](const TestResult& result) {
      return result.node == node && result.test == kCommTestName;
    });
    if (!tested) {
      auto comm = test_communication(*context_, node, {});
      if (!comm) return tl::unexpected<Error>(comm.error());
      comm->origin = origin_of(*context_, node);
      drive.tests.push_back(std::move(*comm));
    }
    for (const auto& result : *earlier_)
      if (result.node == node && !is_superseded(result)) drive.tests.push_back(result);
    for (const auto& result : drive.tests) {
      ++tests_;
      if (passed(result)) continue;
      ++failed_;
      context_->errors.push_back(failure(result));
    }
    return {};
  }

  Context* context_;
  const std::vector<TestResult>* earlier_;
  Report out_;
  std::size_t answered_ = 0;
  std::size_t tests_ = 0;
  std::size_t failed_ = 0;
};

std::string joined(const std::vector<std::string>& remarks) {
  std::string out;
  for (const auto& remark : remarks) out += (out.empty() ? "" : ". ") + remark;
  return out;
}

/// Name and verdict are the heading.
report::Page::Section test_section(const Context& context, const TestResult& test) {
  auto record = verdict_record(context, test, Show::everywhere);
  std::erase_if(record, [](const report::Field& field) {
    return field.key == "test" || field.key == "node" || field.key == "verdict";
  });
  const Value origin(test.origin);
  if (const auto* time = report::find(origin, "time"))
    record.insert(record.begin(), {"time", *time, Show::text, say(context, "made at", "测试时间")});
  return {fmt::format("{}: {}", test.test,
                      passed(test) ? say(context, "passed", "通过") : say(context, "FAILED", "未通过")),
          4,
          std::move(record),
          {}};
}

}  // namespace

Result<Report> make_report(Context& context, std::string title, const std::vector<TestResult>& earlier) {
  return Collection(context, earlier).make(std::move(title));
}

std::string report_page(const Context& context, const Report& report) {
  report::Page page{.chinese = context.chinese, .title = report.title};
  if (context.chinese) page.translate = heading_zh;
  page.sections.push_back({say(context, "Summary", "概要"), 2, report.head, {}});
  page.sections.push_back(
      {report.bus.title, 2, List{report.link, report.bus.value}, joined(report.bus.remarks)});
  for (const auto& drive : report.drives) {
    page.sections.push_back({drive.title, 2, {}, {}});
    for (const auto& part : drive.parts)
      page.sections.push_back({part.title, 3, part.value, joined(part.remarks)});
    if (!drive.tests.empty()) page.sections.push_back({say(context, "Tests", "测试"), 3, {}, {}});
    for (const auto& test : drive.tests) page.sections.push_back(test_section(context, test));
  }
  return report::html_page(page);
}

std::string report_json(const Context& context, const Report& report) {
  List nodes;
  for (const auto& drive : report.drives) {
    Record node{{"node", drive.node}};
    List remarks;
    for (const auto& part : drive.parts) {
      node.push_back({part.id, part.value});
      for (const auto& remark : part.remarks) remarks.emplace_back(remark);
    }
    List tests;
    for (const auto& test : drive.tests) tests.emplace_back(verdict_record(context, test, Show::json));
    node.push_back({"tests", std::move(tests)});
    node.push_back({"remarks", std::move(remarks)});
    nodes.emplace_back(std::move(node));
  }
  Record out{{"servoctl_report", 1}, {"title", report.title}};
  for (const auto& field : report.head) out.push_back(field);
  out.push_back({"link", report.link});
  out.push_back({"found", report.bus.value});
  out.push_back({"nodes", std::move(nodes)});
  return report::to_json(std::move(out)) + "\n";
}

}  // namespace servoctl::commands
