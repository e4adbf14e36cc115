#include "base/version.hpp"
#include "command/command.hpp"
#include "command/man_page.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

Result<report::Value> run_man(Context&, const Arguments&) {
  auto page = man_page(version(), version_date());
  page.pop_back();  // The front end ends the text with a line break.
  return report::Value(std::move(page));
}

constexpr Example kManExamples[] = {
    {"man", "its source; `servoctl man | man -l -` shows it as a page"},
};

}  // namespace

extern const Command kMan;
const Command kMan{
    .path = "man",
    .summary = "Print the manual page of servoctl",
    .details =
        "For `man` to show: `servoctl man | man -l -`. An installed servoctl includes it: `man servoctl`.",
    .parameters = {},
    .examples = kManExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_man,
};

}  // namespace servoctl::commands
