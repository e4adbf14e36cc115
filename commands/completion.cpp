#include "command/command.hpp"
#include "command/completion_words.hpp"
#include "command/shell_completion.hpp"
#include "drive/naming.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr std::string_view kWhat[] = {"bash", "zsh", "fish", "objects", "parameters", "families"};

constexpr Parameter kParameters[] = {
    {.name = "what",
     .help = "a shell, or the names it asks for while you type",
     .kind = Kind::choice,
     .required = true,
     .choices = kWhat},
};

std::string lines(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words)
    if (can_be_offered(word)) out += (out.empty() ? "" : "\n") + word;
  return out;
}

Result<report::Value> run(Context& context, const Arguments& arguments) {
  const auto what = arguments.text("what");
  if (what == "families") {
    std::vector<std::string> names;
    for (const auto& family : drive::find_families(context.drive_folders)) names.push_back(family.name);
    return report::Value(lines(names));
  }
  if (what == "objects" || what == "parameters") {
    if (context.profile == nullptr)
      return fail(Errc::usage, "a drive family is needed", "add -d FAMILY; `drives` lists them");
    if (what == "objects") return report::Value(lines(drive::names(*context.profile)));
    std::vector<std::string> ids;
    for (const auto& parameter : context.profile->parameters) ids.push_back(parameter.id);
    return report::Value(lines(ids));
  }
  auto script = completion_script(what);
  script.pop_back();  // The front end ends the text with a line break.
  return report::Value(std::move(script));
}

}  // namespace

extern const Command kCompletion;
const Command kCompletion{
    .path = "completion",
    .summary = "Print the completion script of a shell",
    .details =
        "bash: put `source <(servoctl completion bash)` into ~/.bashrc. zsh: `servoctl completion zsh > "
        "_servoctl` in a folder of $fpath. fish: `servoctl completion fish > "
        "~/.config/fish/completions/servoctl.fish`. An installed servoctl includes all three.",
    .parameters = kParameters,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run,
};

}  // namespace servoctl::commands
