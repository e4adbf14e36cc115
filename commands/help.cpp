#include "base/text.hpp"
#include "command/help_text.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kHelpParameters[] = {
    {.name = "command",
     .help = "a command, a group, a word of the prompt, or an option: read, param, param set, undo, --for",
     .kind = Kind::command,
     .many = true},
};

Result<report::Value> run_help(Context& context, const Arguments& arguments) {
  std::string path;
  for (const auto& word : arguments.all("command")) append(path, word, " ");
  auto text = help_text(path, context.audience == nullptr ? 0 : context.audience->width(),
                        context.chinese && !context.keeps_samples && !context.wants_records);
  if (!text) return fail(text.error());
  if (!text->empty() && text->back() == '\n') text->pop_back();
  return report::Value(std::move(*text));
}

constexpr Example kHelpExamples[] = {
    {"help", "all commands"},
    {"help param set", "one of them"},
    {"help param", "a group"},
};

}  // namespace

extern const Command kHelp;
const Command kHelp{
    .path = "help",
    .summary = "Show the commands, or how one is used",
    .details = {},
    .parameters = kHelpParameters,
    .examples = kHelpExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_help,
};

}  // namespace servoctl::commands
