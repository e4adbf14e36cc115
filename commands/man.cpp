#include "base/version.hpp"
#include "command/command.hpp"
#include "command/man_page.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

Result<report::Value> run_man(Context& context, const Arguments&) {
  auto page = man_page(version(), version_date(), context.chinese);
  page.pop_back();  // The front end ends the text with a line break.
  return report::Value(std::move(page));
}

constexpr Example kManExamples[] = {
    {"man", "on a terminal the page, where there is a program that shows it"},
    {"man --no-pager", "its source"},
};

}  // namespace

extern const Command kMan;
const Command kMan{
    .path = "man",
    .summary = "Print the manual page of servoctl",
    .details =
        "As a command of its own on a terminal it is shown by `man -l -`, with the pager of that. At the prompt, "
        "in a pipe, with --no-pager, or without a program `man` it is the source. An installed servoctl includes "
        "it: `man servoctl`. With `--lang zh` it is in Chinese.",
    .parameters = {},
    .examples = kManExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_man,
};

}  // namespace servoctl::commands
