#include "cli/batch/batch_check.hpp"

#include <unordered_map>
#include <unordered_set>

#include "base/format.hpp"
#include "cli/output_files.hpp"
#include "cli/parse.hpp"
#include "cli/restriction.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "command/written_words.hpp"
#include "report/catalogue.hpp"
#include "show/chinese_names.hpp"

namespace servoctl::cli {
namespace {

using command::Effect;
using command::Needs;

class Check {
 public:
  explicit Check(Shell& shell) : shell_(&shell), settings_(shell.defaults()) {}

  void take(const Step& step) {
    if (step.kind != Step::Kind::command || is_exit(step.words) || errors_.size() == kMostErrors) return;
    // What a loop says again is right again, as long as nothing was chosen in between.
    if (is_choice(step.words)) right_.clear();
    if (right_.count(step.text) > 0) return;
    if (const auto checked = check(step.words); checked)
      right_.insert(step.text);
    else
      errors_.add(step.line, step.round, checked.error());
  }

  std::vector<Error> done() { return errors_.take(); }

 private:
  Result<void> check(const std::vector<std::string>& words) {
    auto next = chosen(*shell_, settings_, words);
    if (!next) return fail(next.error());
    settings_ = std::move(*next);
    if (is_choice(words) || asks_for_help(words)) return {};
    const auto parsed = parse_line(shell_->name_axes(words, match_command(words)));
    if (!parsed) return fail(parsed.error());
    const auto settings = settings_of(*parsed, settings_);
    if (!settings) return fail(settings.error());
    std::vector<Message> notices;  // The run tells them.
    auto parts = shell_->parts_of_line(*parsed, *settings, notices);
    if (!parts) return fail(parts.error());
    if (parts->empty()) return check_part(*parsed, {*settings, {}, {}});
    for (const auto& part : *parts)
      if (const auto right = check_part(*parsed, part); !right) return right;
    return {};
  }

  /// What nobody could be asked when its turn comes is told before the first line is run.
  Result<void> check_outputs(const ParsedLine& line, const Settings& settings) {
    const bool asks = !settings.yes && shell_->console().can_ask();
    const bool replaces = settings.yes && !settings.read_only;
    if (asks || replaces) return {};
    command::Context context;
    const RunningLine nobody(*shell_, settings, context);
    return admit_outputs(*line.command, line.arguments, settings, context);
  }

  Result<void> check_part(const ParsedLine& line, const LinePart& part) {
    command::Context context;
    if (const auto ready = prepare(line, part.settings, context); !ready) return ready;
    for (const auto* axis : part.axes)
      if (axis->load) context.loads.emplace(axis->node, *axis->load);
    if (const auto right = command::check_written(*line.command, line.arguments); !right) return right;
    if (line.command->check == nullptr) return {};
    auto right = line.command->check(context, line.arguments);
    // What the family calls things, nobody knows any more who tells of the file.
    if (!right && context.profile != nullptr && shell_->defaults().shows_chinese())
      report::put_into_chinese(right.error().message, &names_of(*context.profile));
    return right;
  }

  Result<void> prepare(const ParsedLine& line, const Settings& settings, command::Context& context) {
    const auto& command = *line.command;
    if (const auto allowed = check_allowed(command, line.arguments, settings); !allowed) return allowed;
    if (const auto may = check_outputs(line, settings); !may) return may;
    const auto* restriction = Restriction::current();
    if (restriction != nullptr && includes(command.needs, Needs::bus) && !settings.bus.empty())
      if (const auto allowed = restriction->check_bus(settings.bus); !allowed) return allowed;
    if (includes(command.needs, Needs::node) && settings.nodes.empty()) return fail(no_node(command));
    if (!settings.nodes.empty()) {
      auto nodes = parse_nodes(settings.nodes);
      if (!nodes) return fail(nodes.error());
      context.nodes = std::move(*nodes);
    }
    context.chinese = settings.chinese;
    context.drive_folders = shell_->drive_folders();
    if (settings.drive.empty()) {
      if (!includes(command.needs, Needs::dictionary)) return {};
      return fail(Errc::usage, message("'{}' needs the drive family", as_it_is(command.path)),
                  "add -d FAMILY, or a line `drive FAMILY` before it; `drives` lists families");
    }
    const auto profile = shell_->profile(settings.drive);
    if (!profile) return fail(profile.error());
    context.profile = *profile;
    return {};
  }

  const report::Names& names_of(const drive::Profile& profile) {
    const auto [known, added] = names_.try_emplace(&profile);
    if (added) known->second = show::chinese_names(profile);
    return known->second;
  }

  Shell* shell_;
  Settings settings_;
  std::unordered_map<const drive::Profile*, report::Names> names_;
  std::unordered_set<std::string> right_;  ///< Lines that were checked with these settings.
  LineErrors errors_;
};

}  // namespace

std::vector<Error> check_steps(Shell& shell, std::span<const Step> steps) {
  Check check(shell);
  for (const auto& step : steps) check.take(step);
  return check.done();
}

}  // namespace servoctl::cli
