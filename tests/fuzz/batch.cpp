// A batch file: taken apart, its loops unrolled, every line of it parsed.
#include "cli/batch/batch_plan.hpp"
#include "cli/parse.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 2000) return 0;
  const auto batch = cli::parse_batch(fuzz::text(data, size));
  const auto plan = cli::plan_batch(batch, {}, "/nowhere");
  for (const auto& error : plan.errors) fuzz::require(error.line.has_value(), "an error has a line");
  std::size_t tried = 0;
  for (const auto& step : plan.steps) {
    if (++tried > 100) break;
    (void)cli::parse_line(step.words);
    if (step.kind == cli::Step::Kind::expect) (void)cli::expect(step.expression, report::List{1, "text"});
    if (step.kind == cli::Step::Kind::command)
      fuzz::require(cli::split_words(step.text).value() == step.words, "a line is what its words are");
  }
  return 0;
}
