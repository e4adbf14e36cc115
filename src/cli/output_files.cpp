#include "cli/output_files.hpp"

#include <algorithm>
#include <string_view>

#include "command/output_form.hpp"
#include "show/output_file.hpp"

namespace servoctl::cli {
namespace {

/// Options that name a file which is written, whatever the command.
constexpr std::string_view kOptions[] = {"--to", "--csv", "--svg", "--junit", "--trace"};

/// Commands whose own words do. `backup` may write a folder of files and asks about each itself.
struct Word {
  std::string_view command;
  std::string_view name;
};
constexpr Word kWords[] = {{"pdo save", "file"},
                           {"report", "file"},
                           {"report", "--output"},
                           {"witness", "file"},
                           {"eds learn", "--output"}};

}  // namespace

bool is_output(const command::Command& command, const command::Parameter& parameter) {
  if (parameter.kind != command::Kind::file) return false;
  if (std::find(std::begin(kOptions), std::end(kOptions), parameter.name) != std::end(kOptions)) return true;
  return std::any_of(std::begin(kWords), std::end(kWords), [&](const Word& word) {
    return word.command == command.path && word.name == parameter.name;
  });
}

std::vector<std::filesystem::path> output_files(const command::Command& command,
                                                const command::Arguments& arguments, bool dry_run) {
  std::vector<std::filesystem::path> out;
  const auto add = [&](const command::Parameter& parameter) {
    if (!is_output(command, parameter)) return;
    for (const auto& word : arguments.all(parameter.name))
      if (parameter.name != "--output" || !command::is_output_form(word)) out.emplace_back(word);
  };
  const bool writes_none = dry_run && command.effect_with(arguments) > command::Effect::reads;
  if (!writes_none) std::for_each(command.parameters.begin(), command.parameters.end(), add);
  const auto global = command::global_options();
  std::for_each(global.begin(), global.end(), add);
  return out;
}

Result<void> admit_outputs(const command::Command& command, const command::Arguments& arguments,
                           const Settings& settings, const show::Desk& desk) {
  for (const auto& file : output_files(command, arguments, settings.dry_run))
    if (const auto may = show::may_replace(file, settings.read_only, desk); !may) return may;
  return {};
}

}  // namespace servoctl::cli
