#include "base/text.hpp"
#include "command/help_text.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kHelpParameters[] = {
    {.name = "command",
     .help = "a command or a group: read, param, param set",
     .kind = Kind::command,
     .many = true},
};

Result<report::Value> run_help(Context&, const Arguments& arguments) {
  std::string path;
  for (const auto& word : arguments.all("command")) append(path, word, " ");
  auto text = help_text(path, 0);
  if (!text) return fail(text.error());
  if (!text->empty() && text->back() == '\n') text->pop_back();
  return report::Value(std::move(*text));
}

}  // namespace

extern const Command kHelp;
const Command kHelp{
    .path = "help",
    .summary = "Show the commands, or how one is used",
    .details = {},
    .parameters = kHelpParameters,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_help,
};

}  // namespace servoctl::commands
