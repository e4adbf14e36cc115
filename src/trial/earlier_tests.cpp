#include "trial/earlier_tests.hpp"

#include <algorithm>
#include <array>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/cob_id.hpp"
#include "session/open_bus.hpp"
#include "show/identity.hpp"
#include "trial/figures.hpp"

namespace servoctl::trial {
namespace {

using report::Criterion;
using report::find;
using report::List;
using report::TestResult;
using report::Value;
using report::Verdict;

constexpr std::string_view kTestCommand = "test ";

std::string text(const Value* value) {
  const auto* found = value == nullptr ? nullptr : std::get_if<std::string>(&value->data());
  return found == nullptr ? std::string() : *found;
}

double number_of(const Value* value) {
  if (value == nullptr) return 0;
  if (const auto* real = std::get_if<double>(&value->data())) return *real;
  const auto* whole = std::get_if<std::uint64_t>(&value->data());
  return whole == nullptr ? 0 : static_cast<double>(*whole);
}

/// The relations a criterion may have, which outlive the file.
std::string_view relation(const std::string& text) {
  for (const std::string_view known : {"<=", ">=", "="})
    if (known == text) return known;
  return {};
}

std::optional<Criterion> criterion_of(const Value& value) {
  Criterion out{.id = text(find(value, "id")),
                .name = text(find(value, "name")),
                .relation = relation(text(find(value, "relation"))),
                .unit = text(find(value, "unit")),
                .note = text(find(value, "note"))};
  const auto verdict = text(find(value, "verdict"));
  constexpr std::array kVerdicts{Verdict::passed, Verdict::failed, Verdict::skipped};
  const auto* found =
      std::find_if(kVerdicts.begin(), kVerdicts.end(), [&](Verdict v) { return report::name(v) == verdict; });
  if (out.id.empty() || found == kVerdicts.end()) return std::nullopt;
  out.verdict = *found;
  if (const auto* figure = find(value, "figure")) out.figure = *figure;
  if (const auto* limit = find(value, "limit")) out.limit = *limit;
  return out;
}

std::optional<TestResult> test_of(const show::Desk& desk, const Value& value) {
  TestResult out;
  out.test = text(find(value, "test"));
  const auto* node = find(value, "node");
  const auto* number = node == nullptr ? nullptr : std::get_if<std::uint64_t>(&node->data());
  const auto* criteria = find(value, "criteria");
  const auto* list = criteria == nullptr ? nullptr : std::get_if<List>(&criteria->data());
  if (out.test.empty() || number == nullptr || *number < canopen::kFirstNode ||
      *number > canopen::kLastNode || list == nullptr)
    return std::nullopt;
  out.node = static_cast<std::uint8_t>(*number);
  for (const auto* key : {"time", "family", "identity"})
    if (const auto* told = find(value, key)) out.origin.push_back({key, *told});
  for (const auto& one : *list) {
    auto criterion = criterion_of(one);
    if (!criterion) return std::nullopt;
    out.criteria.push_back(std::move(*criterion));
  }
  if (const auto* samples = find(value, "samples")) {
    auto plot = report::plot_of(*samples);
    if (!plot) return std::nullopt;
    out.samples = std::move(*plot);
  }
  out.seconds = number_of(find(value, "seconds"));
  out.figures = figures_of(desk, out, value);
  return out;
}

tl::unexpected<Error> no_tests(std::string_view file) {
  return fail(Errc::file, message("{} contains no test results", as_it_is(file)),
              "such a file is written by `test … --json >FILE`");
}

/// What is said of a test that did not come to its end: it is no test that passed.
std::optional<TestResult> broken_off(const Value& document, const std::vector<TestResult>& before) {
  const auto* error = find(document, "error");
  if (error == nullptr) return std::nullopt;
  const auto* node = find(*error, "node");
  const auto* number = node == nullptr ? nullptr : std::get_if<std::uint64_t>(&node->data());
  // The last one may be what the error is about, such as a jog that Ctrl-C ended: it says so itself.
  const bool told =
      !before.empty() && !passed(before.back()) && number != nullptr && before.back().node == *number;
  const bool any = std::any_of(before.begin(), before.end(), [](const TestResult& t) { return !passed(t); });
  if (told || (any && text(find(*error, "code")) == name(Errc::negative))) return std::nullopt;
  TestResult out;
  out.test = text(find(document, "command")).substr(kTestCommand.size());
  if (number != nullptr && *number >= canopen::kFirstNode && *number <= canopen::kLastNode)
    out.node = static_cast<std::uint8_t>(*number);
  else if (!before.empty())
    out.node = before.back().node;
  if (!before.empty()) out.origin = before.back().origin;
  out.criteria.push_back({.id = "ended",
                          .name = "ended without an error",
                          .verdict = Verdict::failed,
                          .figure = text(find(*error, "message")),
                          .relation = {}});
  return out;
}

Result<void> add_tests(const show::Desk& desk, const Value& document, std::string_view file,
                       std::vector<EarlierTest>& out) {
  const auto* result = find(document, "result");
  const auto* list = result == nullptr ? nullptr : std::get_if<List>(&result->data());
  if (list == nullptr || !text(find(document, "command")).starts_with(kTestCommand)) return no_tests(file);
  std::vector<TestResult> tests;
  std::vector<std::string> axes;
  for (const auto& one : *list) {
    auto test = test_of(desk, one);
    if (!test) return no_tests(file);
    tests.push_back(std::move(*test));
    axes.push_back(text(find(one, "axis")));
  }
  if (auto last = broken_off(document, tests)) {
    if (last->node == 0)
      return fail(
          Errc::file,
          message("{}: the test did not run: {}", as_it_is(file), text(&last->criteria.front().figure)),
          "run it again, or leave this --tests out");
    tests.push_back(std::move(*last));
    auto axis = text(find(*find(document, "error"), "axis"));
    axes.push_back(axis.empty() && !axes.empty() ? axes.back() : std::move(axis));
  }
  const auto bus = text(find(document, "bus"));
  for (std::size_t i = 0; i < tests.size(); ++i) out.push_back({std::move(tests[i]), axes[i], bus});
  return {};
}

/// What says that the test was made of another drive than this one; empty when nothing does, nothing when it
/// does not tell.
std::optional<std::string> otherness(const show::Desk& desk, const TestResult& test,
                                     const session::Identity& drive) {
  const Value origin(test.origin);
  const auto family = text(find(origin, "family"));
  if (!family.empty() && family != desk.profile->family) return formatted("it was a {}", family);
  const auto* record = find(origin, "identity");
  const auto identity = record == nullptr ? std::nullopt : show::identity_of(*record, test.node);
  if (!identity || record->is_null()) return std::nullopt;
  auto out = show::other_kind(*identity, drive);
  if (out.empty() && identity->serial && drive.serial && identity->serial != drive.serial)
    out = "its serial number (1018h:04)";
  return out.empty() ? out : out + " differs";
}

Error other_drive(const TestResult& test, const Message& what) {
  const auto time = text(find(Value(test.origin), "time"));
  return drive_error(Errc::refused, test.node,
                     message("`test {}`{} was run on another drive: {}", as_it_is(test.test),
                             time.empty() ? Message() : message(" of {}", as_it_is(time)), what),
                     "leave this --tests out, or test the present drive");
}

}  // namespace

Result<std::vector<EarlierTest>> read_tests(const show::Desk& desk, const std::filesystem::path& file) {
  const auto content = read_file(file);
  if (!content) return fail(content.error());
  std::vector<EarlierTest> out;
  const auto whole = report::parse_json(*content, file.string());
  if (whole) {
    if (const auto added = add_tests(desk, *whole, file.string(), out); !added) return fail(added.error());
    return out;
  }
  for (const auto line : split(std::string_view(*content), '\n')) {
    if (trim(line).empty()) continue;
    const auto document = report::parse_json(line, file.string());
    if (!document) return fail(whole.error());
    if (const auto added = add_tests(desk, *document, file.string(), out); !added) return fail(added.error());
  }
  if (out.empty()) return no_tests(file.string());
  return out;
}

bool is_of(const EarlierTest& test, const TestedDrive& drive) {
  if (!test.axis.empty() && !drive.axis.empty()) return test.axis == drive.axis;
  const bool same_bus =
      drive.bus.empty() || session::canonical_url(test.bus) == session::canonical_url(drive.bus);
  return test.result.node == drive.node && same_bus;
}

Result<void> check_tested(show::Desk& desk, const std::vector<TestResult>& tests) {
  std::vector<std::uint8_t> nodes;
  for (const auto node : desk.nodes)
    if (std::any_of(tests.begin(), tests.end(), [&](const TestResult& test) { return test.node == node; }))
      nodes.push_back(node);
  if (nodes.empty()) return {};
  const auto found = session::scan(*desk.session, nodes);
  if (!found) return fail(found.error());
  for (const auto& drive : *found)
    for (const auto& test : tests) {
      if (test.node != drive.node) continue;
      const auto what = otherness(desk, test, drive);
      if (!what)
        desk.notices.push_back(message("node {}: `test {}` does not say which drive it was run on",
                                       node_name(test.node), as_it_is(test.test)));
      else if (!what->empty())
        return fail(other_drive(test, *what));
    }
  return {};
}

}  // namespace servoctl::trial
