#include <algorithm>

#include "base/text.hpp"
#include "command/command.hpp"
#include "command/shell_completion.hpp"
#include "drive/naming.hpp"
#include "drive/topics.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr std::string_view kWhat[] = {"bash", "zsh", "fish", "objects", "parameters", "topics", "families"};

constexpr Parameter kCompletionParameters[] = {
    {.name = "what",
     .help = "a shell; or names for scripts, one a line",
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

/// What can be explained: names of topics, of those of several words the first, and of a family its objects
/// and parameters.
Result<report::Value> topic_names(const Context& context) {
  const drive::Profile none;
  const auto topics =
      drive::load_topics(context.profile == nullptr ? none : *context.profile, context.drive_folders);
  if (!topics) return fail(topics.error());
  std::vector<std::string> names;
  for (const auto& topic : *topics)
    if (std::string word(split(topic.name, ' ').front());
        std::find(names.begin(), names.end(), word) == names.end())
      names.push_back(std::move(word));
  if (context.profile != nullptr)
    for (auto& name : drive::names(*context.profile)) names.push_back(std::move(name));
  return report::Value(lines(names));
}

Result<report::Value> run_completion(Context& context, const Arguments& arguments) {
  const auto what = arguments.text("what");
  if (what == "families") {
    std::vector<std::string> names;
    for (const auto& family : drive::find_families(context.drive_folders)) names.push_back(family.name);
    return report::Value(lines(names));
  }
  if (what == "topics") return topic_names(context);
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

constexpr Example kCompletionExamples[] = {
    {"completion zsh", "the script; `help completion` says where it belongs"},
};

}  // namespace

extern const Command kCompletion;
const Command kCompletion{
    .path = "completion",
    .summary = "Print the completion script of a shell",
    .details =
        "bash: put `source <(servoctl completion bash)` into ~/.bashrc. zsh: `servoctl completion zsh > "
        "_servoctl` in a folder of $fpath. fish: `servoctl completion fish > "
        "~/.config/fish/completions/servoctl.fish`. An installed servoctl includes all three. At each Tab the "
        "script asks the program, which completes the line as the prompt does, for its -b, -n, -d and --cabinet "
        "or the environment: it reads files, opens no bus and sends nothing.",
    .parameters = kCompletionParameters,
    .examples = kCompletionExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_completion,
};

}  // namespace servoctl::commands
