#include "cli/shell.hpp"

#include <unistd.h>

#include <algorithm>
#include <span>
#include <utility>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "cli/axis_word.hpp"
#include "cli/hint_place.hpp"
#include "cli/output_files.hpp"
#include "cli/terminal/signals.hpp"
#include "command/help_text.hpp"
#include "report/catalogue.hpp"
#include "session/scan.hpp"
#include "session/serve_registers.hpp"
#include "session/serve_ring.hpp"
#include "show/records.hpp"

namespace servoctl::cli {
namespace {

using command::Effect;
using command::Needs;
using report::Value;

/// Whatever is told of a line speaks of axes by their names.
void name_axes_in(const show::AxisNames& names, command::Context& context, Value& result) {
  for (auto& error : context.errors)
    for (auto* part : {&error.message, &error.hint}) names.put_into(*part);
  for (auto& notice : context.notices) names.put_into(notice);
  names.put_into(result);
}

/// What is told of `node 3` is looked for under that name, before it has another.
void put_into_chinese(command::Context& context, const report::Names* of_family) {
  for (auto& error : context.errors)
    for (auto* part : {&error.message, &error.hint}) report::put_into_chinese(*part, of_family);
  for (auto& notice : context.notices) report::put_into_chinese(notice, of_family);
}

/// What nobody took from the output in time.
void tell_unread(Console& console, std::vector<Message>& notices) {
  if (const auto left_out = console.take_left_out(); left_out > 0)
    notices.push_back(message(
        "{} samples were not shown: the output was not read in time; --csv has every sample", left_out));
  if (const auto untold = console.take_untold(); untold > 0)
    notices.push_back(message("{} messages were not shown: the output was not read in time", untold));
}

}  // namespace

Shell::Shell(Console& console, Options options)
    : console_(&console),
      options_(std::move(options)),
      progress_(console),
      protection_([this](session::Care worst) {
        protect_from_signals(worst != session::Care::none);
        // No motor waits for what is put in order: who reads is waited for as ever.
        console_->set_care(worst == session::Care::unsettled ? session::Care::none : worst);
      }),
      bus_(console, {.drive_folders = options_.drive_folders, .trace = {}, .clock = options_.clock},
           session_options(), options_.state_folder) {
  console_->set_chinese(options_.defaults.chinese);
}

int Shell::run(const std::vector<std::string>& words) { return show(*console_, perform(words)); }

Result<Settings> settings_of(const ParsedLine& line, const Settings& defaults) {
  auto out = apply_options(defaults, line.arguments);
  if (out && line.command->all_by_default && !out->nodes_typed()) out->nodes = "all";
  return out;
}

Outcome Shell::perform(const std::vector<std::string>& words) {
  const auto match = match_command(words);
  const auto path = match.command != nullptr ? match.command->path : std::string_view();
  auto settings = options_.defaults;
  settings.json = settings.json || wants_json(words);
  settings.chinese = wants_chinese(words, settings.chinese);
  console_->set_chinese(settings.chinese);
  console_->set_colour(settings.colour = wanted_colour(words, settings.colour));
  if (asks_for_help(words)) return help(words, std::move(settings));
  auto parsed = parse_line(name_axes(words, match));
  if (!parsed) {
    const auto known = [this] { return cabinet_.get(options_.defaults); };
    return failed(about_axis(parsed.error(), words, match, known), std::move(settings), path);
  }
  const auto applied = settings_of(*parsed, options_.defaults);
  if (!applied) return failed(applied.error(), std::move(settings), path);
  console_->set_quiet(applied->quiet);
  const ShownWait shown(*this);
  console_->set_verbose(applied->verbose);
  console_->set_waits_for_none(false);  // As the last line may have wanted it.
  cabinet_told_ = false;
  told_energised_.clear();
  auto out = perform_parsed(*parsed, *applied);
  // What is done behind the last line is done for it.
  if (stays_open_) console_->set_verbose(options_.defaults.verbose);
  const auto told = told_of_words(*parsed->command, parsed->arguments);
  out.notices.insert(out.notices.begin(), told.begin(), told.end());
  return with_place(std::move(out), *parsed);
}

/// Help is text for a person, whatever form results have.
Outcome Shell::help(const std::vector<std::string>& words, Settings settings) {
  const auto match = match_command(words);
  const std::string path = match.command != nullptr     ? std::string(match.command->path)
                           : match.first < words.size() ? words[match.first]
                                                        : std::string();
  auto text = command::help_text(path, console_->width(), settings.chinese);
  if (!text) return failed(text.error(), std::move(settings));
  settings.json = false;
  if (!text->empty() && text->back() == '\n') text->pop_back();
  return {.command = "help", .settings = std::move(settings), .result = std::move(*text)};
}

Result<void> Shell::make_ready(Run& run, const command::Arguments& arguments) {
  run.turn = arguments.text("--turn");
  if (const auto ready = prepare(run, arguments); !ready) return ready;
  auto& context = run.context;
  context.axes = run.axes;
  context.nodes_typed = run.settings.nodes_typed();
  context.chinese = run.settings.chinese;
  context.json = run.settings.json;
  context.dry_run = run.settings.dry_run;
  context.read_only = run.settings.read_only;
  context.stays_open = stays_open_;
  context.disables_at_end = disables_at_end_;
  context.drive_folders = options_.drive_folders;
  context.state_folder = options_.state_folder;
  context.keeps_samples = run.settings.json && !run.settings.samples;
  context.wants_records = run.settings.samples;
  for (const auto* axis : run.axes)
    if (axis->load) context.loads.emplace(axis->node, *axis->load);
  return {};
}

Result<void> Shell::prepare(Run& run, const command::Arguments& arguments) {
  const auto& command = *run.command;
  if (const auto allowed = check_allowed(command, arguments, run.settings); !allowed) return allowed;
  if (const auto right = check_whole_file(command, run.settings); !right) return right;
  const bool on_bus = includes(command.needs, Needs::bus) && !command.opens_bus;
  // What is wrong in the line itself is told before a bus is opened or a drive asked for its family.
  if (on_bus && includes(command.needs, Needs::node) && run.settings.nodes.empty())
    return fail(no_node(command));
  if (const auto right = check_words(command, run.context, arguments); !right) return right;
  if (const auto may = admit_outputs(command, arguments, run.settings, run.context); !may) return may;
  const bool in_file = !command.families_in.empty() && arguments.has(command.families_in);
  if (!run.settings.drive.empty() || (includes(command.needs, Needs::dictionary) && !in_file) ||
      (on_bus && names_objects(command, arguments)))
    if (const auto ready = prepare_profile(run, command.effect_with(arguments) > Effect::reads); !ready)
      return ready;
  find_standard_names(run);
  if (!on_bus) return name_nodes(run);
  if (!run.settings.nodes.empty())
    if (const auto nodes = parse_nodes(run.settings.nodes); !nodes) return fail(nodes.error());
  const auto opened = open(run.settings);
  if (!opened) return fail(opened.error());
  run.context.session = *opened;
  run.energised_before = (*opened)->energised().nodes();
  if (console_->is_verbose()) tell_place(run);
  if (const auto fits = check_registers(command, **opened, run.context.profile, run.settings.chinese); !fits)
    return fits;
  if (const auto possible = admit(command, arguments, **opened); !possible) return possible;
  if (const auto named = prepare_nodes(run); !named) return named;
  be_wary(run, arguments);
  const auto weight = weight_of(command, arguments);
  run.changes = weight == FamilyGate::Weight::changes && !run.settings.dry_run;
  run.line.wait_for_late(command.effect_with(arguments) >= command::Effect::stores);
  if (const auto held = run.line.hold_family(run.context.nodes, run.context.profile, weight); !held)
    return held;
  const bool changes = command.effect_with(arguments) >= Effect::writes && !command.way_out;
  return changes ? hold_serials(run) : Result<void>();
}

/// Where no family is named, standard objects still have names.
void Shell::find_standard_names(Run& run) {
  const auto& words = run.command->parameters;
  const bool shows_objects = std::any_of(words.begin(), words.end(), [](const command::Parameter& word) {
    return word.kind == command::Kind::object;
  });
  if (run.context.profile != nullptr || !shows_objects) return;
  run.context.standard = profile(std::string(drive::kGenericFamily)).value_or(nullptr);
}

/// A command without a bus takes the nodes as they are written.
Result<void> Shell::name_nodes(Run& run) {
  if (run.settings.nodes.empty()) return {};
  auto nodes = parse_nodes(run.settings.nodes);
  if (!nodes) return fail(nodes.error());
  run.context.nodes = std::move(*nodes);
  return {};
}

Result<void> Shell::prepare_nodes(Run& run) {
  if (run.settings.nodes.empty()) return {};
  auto nodes = parse_nodes(run.settings.nodes);
  if (!nodes) return fail(nodes.error());
  const bool reaches_silent =
      run.command->to_silent && !run.settings.dry_run && run.context.session->can() != nullptr;
  const bool takes_all = run.command->to_all || reaches_silent || !includes(run.command->needs, Needs::node);
  if (nodes->front() == 0 && !takes_all) {
    nodes = session::nodes_present(*run.context.session);
    // Where nobody can be looked for, what is known to be energised is still to be stopped.
    const auto& energised = run.context.session->energised().nodes();
    if (!nodes && run.command->way_out && !energised.empty())
      nodes = std::vector(energised.begin(), energised.end());
    if (!nodes) return fail(nodes.error());
  }
  run.context.nodes = std::move(*nodes);
  return {};
}

/// What waits for a restart is known to the next line, and outlives the process.
void Shell::keep_restarts() {
  for (auto* session : bus_.sessions())
    if (auto* watch = bus_.restarts(*session))
      if (const auto kept = watch->keep(); !kept)
        console_->note(formatted("notice: what waits for a restart is not remembered: {}\n",
                                 printable(kept.error().message.text())));
}

Outcome Shell::finish(Run& run, const Result<Value>& result) {
  auto& errors = run.context.errors;
  judge_writes(run);
  keep_restarts();
  const bool met_loss = run.context.session != nullptr && run.context.session->take_met_loss();
  hear_second_node(run);
  if (!result) errors.insert(errors.begin(), result.error());
  const bool is_lost = tell_lost_bus(run, met_loss);
  if (!is_lost) tell_energised(run);
  tell_second_node(run);
  learn_from(run);
  for (auto& notice : take_notices(run.context.profile, run.settings.chinese))
    run.context.notices.push_back(std::move(notice));
  tell_unread(*console_, run.context.notices);
  for (auto& error : errors) show::name_abort(run.context.profile, run.settings.shows_chinese(), error);
  tell_trace_failure(run);
  auto* session = run.context.session;
  const bool leaves_power = session != nullptr && !session->energised().empty();
  // The next line opens it again: a lost interface does not come back by itself, and behind one that did
  // others may be.
  if (is_lost || (session != nullptr && session->was_away())) bus_.lose(*session);
  auto words = errors.empty() ? std::string() : show::abort_words(run.context, errors.front());
  auto value = result ? *result : Value();
  std::string axis;
  if (!errors.empty() && errors.front().node) axis = run.settings.names.of(*errors.front().node);
  const auto* const of_family = run.line.chinese_names();
  if (run.settings.shows_chinese()) put_into_chinese(run.context, of_family);
  name_axes_in(run.settings.names, run.context, value);
  return {.command = std::string(run.command->path),
          .settings = run.settings,
          .uses_bus = includes(run.command->needs, Needs::bus) || run.context.session != nullptr,
          .result = std::move(value),
          .errors = std::move(errors),
          .notices = std::move(run.context.notices),
          .told = run.settings.shows_chinese(),
          .leaves_power = leaves_power,
          .abort_words = std::move(words),
          .axis = std::move(axis),
          .names = of_family != nullptr ? *of_family : report::Names()};
}

Result<session::Session*> Shell::open(const Settings& settings) {
  auto opened = bus_.open(settings);
  // A drive may have started since the last line.
  if (opened)
    if (auto* watch = bus_.restarts(**opened)) (void)watch->keep();
  return opened;
}

Result<std::unique_ptr<session::RingEnd>> Shell::open_ring_end(const Settings& settings) {
  return bus_.open_ring_end(settings);
}

Result<std::unique_ptr<session::RegisterEnd>> Shell::open_register_end(const Settings& settings) {
  return bus_.open_register_end(settings);
}

int Shell::report_error(const Error& error, bool json, std::string_view command) {
  Settings settings;
  settings.json = json;
  settings.chinese = console_->chinese();
  return show(*console_, failed(error, std::move(settings), command));
}

}  // namespace servoctl::cli
