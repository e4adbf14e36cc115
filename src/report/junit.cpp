#include <algorithm>

#include "base/format.hpp"
#include "report/markup.hpp"
#include "report/verdict.hpp"

namespace servoctl::report {
namespace {

std::size_t count(const TestResult& result, Verdict verdict) {
  return static_cast<std::size_t>(
      std::count_if(result.criteria.begin(), result.criteria.end(),
                    [&](const Criterion& criterion) { return criterion.verdict == verdict; }));
}

std::string case_xml(const TestResult& result, const Criterion& criterion) {
  const auto words = escaped(in_words(criterion).text());
  const auto head = formatted(R"(    <testcase classname="servoctl.{}.node-{}" name="{}" time="0")",
                              escaped(result.test), result.node, escaped(criterion.id));
  switch (criterion.verdict) {
    case Verdict::failed:
      return formatted(
          "{}>\n      <failure message=\"{}\" type=\"limit\">{}: {}</failure>\n    </testcase>\n", head,
          words, escaped(criterion.name), words);
    case Verdict::skipped:
      return formatted("{}>\n      <skipped message=\"{}\"/>\n    </testcase>\n", head, words);
    case Verdict::passed: break;
  }
  return formatted("{}>\n      <system-out>{}: {}</system-out>\n    </testcase>\n", head,
                   escaped(criterion.name), words);
}

std::string suite_xml(const TestResult& result) {
  auto out = formatted(
      "  <testsuite name=\"{} node {}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\" "
      "time=\"{:.3f}\">\n",
      escaped(result.test), result.node, result.criteria.size(), count(result, Verdict::failed),
      count(result, Verdict::skipped), result.seconds);
  for (const auto& criterion : result.criteria) out += case_xml(result, criterion);
  return out + "  </testsuite>\n";
}

}  // namespace

std::string junit_xml(const std::vector<TestResult>& results) {
  std::size_t tests = 0;
  std::size_t failures = 0;
  double seconds = 0;
  std::string suites;
  for (const auto& result : results) {
    tests += result.criteria.size();
    failures += count(result, Verdict::failed);
    seconds += result.seconds;
    suites += suite_xml(result);
  }
  return formatted(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"servoctl\" tests=\"{}\" "
      "failures=\"{}\" errors=\"0\" time=\"{:.3f}\">\n{}</testsuites>\n",
      tests, failures, seconds, suites);
}

}  // namespace servoctl::report
