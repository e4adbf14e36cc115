#include "cli/shell.hpp"

#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <span>
#include <utility>

#include "base/object_address.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "cli/terminal/signals.hpp"
#include "command/help_text.hpp"
#include "report/catalogue.hpp"
#include "session/ethercat_network.hpp"
#include "session/modbus_network.hpp"
#include "session/scan.hpp"
#include "session/serve_registers.hpp"
#include "session/serve_ring.hpp"
#include "show/records.hpp"

namespace servoctl::cli {
namespace {

using command::Effect;
using command::Needs;
using report::Value;

/// How a slave is reached, and which registers a unit has, the data of its family tell.
void learn_family(session::Session& session, std::span<const std::uint8_t> nodes,
                  const drive::Profile& profile) {
  auto* ring = session.ethercat();
  auto* line = session.modbus();
  for (const auto node : nodes) {
    if (ring != nullptr) ring->learn(node, profile.rules.coe);
    if (line != nullptr) line->learn(node, profile.rules.modbus);
  }
}

/// Whether a word stands for objects that only a dictionary knows: a name, or a pattern.
bool names_objects(const command::Command& command, const command::Arguments& arguments) {
  const auto is_name = [](const std::string& word) { return !parse_object_address(word); };
  return std::any_of(command.parameters.begin(), command.parameters.end(), [&](const auto& parameter) {
    const auto words = arguments.all(parameter.name);
    return parameter.kind == command::Kind::object && std::any_of(words.begin(), words.end(), is_name);
  });
}

/// Whatever is told of a line speaks of axes by their names.
void name_axes_in(const show::AxisNames& names, command::Context& context, Value& result) {
  for (auto& error : context.errors) {
    error.message = names.in(error.message);
    error.hint = names.in(error.hint);
  }
  for (auto& notice : context.notices) notice = names.in(notice);
  names.put_into(result);
}

/// What is told of `node 3` is looked for under that name, before it has another.
void put_into_chinese(command::Context& context) {
  for (auto& error : context.errors) {
    error.message = report::in_chinese(error.message);
    error.hint = report::in_chinese(error.hint);
  }
  for (auto& notice : context.notices) notice = report::in_chinese(notice);
}

}  // namespace

Shell::Shell(Console& console, Options options)
    : console_(&console),
      options_(std::move(options)),
      progress_(console),
      protection_([this](session::Care worst) {
        protect_from_signals(worst != session::Care::none);
        console_->set_care(worst);
      }),
      bus_(console, {.drive_folders = options_.drive_folders, .trace = {}, .clock = options_.clock},
           session_options()) {
  console_->set_chinese(options_.defaults.chinese);
}

session::Options Shell::session_options() {
  session::Options out;
  out.cancelled = options_.cancelled;
  out.protection = &protection_;
  // Two that start at once have process numbers close together, or other times.
  constexpr std::uint64_t kSpread = 0x9E37'79B9'7F4A'7C15;
  const auto time = static_cast<std::uint64_t>(steady_now().time_since_epoch().count());
  out.claim_seed = (static_cast<std::uint64_t>(::getpid()) * kSpread ^ time * kSpread) >> 16U;
  out.tell = [this](std::string_view line) {
    const auto turn = take_turn();
    progress_.end();
    console_->note("notice: " + std::string(line) + "\n");
  };
  out.progress = [this](std::size_t done, std::optional<std::size_t> total, TimePoint now) {
    const auto turn = take_turn();
    progress_.update(done, total, now);
  };
  out.list_progress = [this](std::size_t done, std::size_t total, TimePoint now) {
    const auto turn = take_turn();
    progress_.update_list(done, total, now);
  };
  return out;
}

int Shell::run(const std::vector<std::string>& words) { return show(*console_, perform(words)); }

Outcome Shell::perform(const std::vector<std::string>& words) {
  const auto match = match_command(words);
  const auto path = match.command != nullptr ? match.command->path : std::string_view();
  auto settings = options_.defaults;
  settings.json = settings.json || wants_json(words);
  settings.chinese = wants_chinese(words, settings.chinese);
  console_->set_chinese(settings.chinese);
  if (asks_for_help(words)) return help(words, std::move(settings));
  auto parsed = parse_line(name_axes(words, match));
  if (!parsed) return failed(parsed.error(), std::move(settings), path);
  auto applied = apply_options(options_.defaults, parsed->arguments);
  if (!applied) return failed(applied.error(), std::move(settings), path);
  console_->set_quiet(applied->quiet);
  return perform_parsed(*parsed, *applied);
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
  context.nodes_typed = run.settings.nodes_typed;
  context.chinese = run.settings.chinese;
  context.dry_run = run.settings.dry_run;
  context.read_only = run.settings.read_only;
  context.stays_open = stays_open_;
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
  const bool on_bus = includes(command.needs, Needs::bus) && !command.opens_bus;
  // What is wrong in the line itself is told before a bus is opened or a drive asked for its family.
  if (on_bus && includes(command.needs, Needs::node) && run.settings.nodes.empty())
    return fail(no_node(command));
  if (const auto right = check_words(command, run.context, arguments); !right) return right;
  if (!run.settings.drive.empty() || includes(command.needs, Needs::dictionary) ||
      (on_bus && names_objects(command, arguments)))
    if (const auto ready = prepare_profile(run, command.effect_with(arguments) > Effect::reads); !ready)
      return ready;
  if (!on_bus) return name_nodes(run);
  if (!run.settings.nodes.empty())
    if (const auto nodes = parse_nodes(run.settings.nodes); !nodes) return fail(nodes.error());
  const auto opened = open(run.settings);
  if (!opened) return fail(opened.error());
  run.context.session = *opened;
  if (const auto fits = check_registers(command, **opened, run.context.profile, run.settings.chinese); !fits)
    return fits;
  if (const auto possible = admit(command, arguments, **opened); !possible) return possible;
  if (const auto named = prepare_nodes(run); !named) return named;
  if (run.context.profile != nullptr) learn_family(**opened, run.context.nodes, *run.context.profile);
  const auto weight = weight_of(command, arguments);
  if (const auto held = run.line.hold_family(run.context.nodes, run.context.profile, weight); !held)
    return held;
  return weight == FamilyGate::Weight::changes ? hold_serials(run) : Result<void>();
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
    if (!nodes) return fail(nodes.error());
  }
  run.context.nodes = std::move(*nodes);
  return {};
}

Outcome Shell::finish(Run& run, const Result<Value>& result) {
  auto& errors = run.context.errors;
  hear_second_node(run);
  if (!result) errors.insert(errors.begin(), result.error());
  learn_from(run);
  for (auto& notice : take_notices(run.context.profile, run.settings.chinese))
    run.context.notices.push_back(std::move(notice));
  if (const auto left_out = console_->take_left_out(); left_out > 0)
    run.context.notices.push_back(fmt::format(
        "{} samples were not shown: the output was not read in time; --csv has every sample", left_out));
  if (const auto untold = console_->take_untold(); untold > 0)
    run.context.notices.push_back(
        fmt::format("{} messages were not shown: the output was not read in time", untold));
  for (auto& error : errors) show::name_abort(run.context, error);
  if (auto failure = bus_.take_trace_failure()) {
    // The line was carried out; those that follow are too.
    if (stays_open_) {
      run.context.notices.push_back(failure->message + "; " + failure->hint);
      incomplete_trace_ = std::move(failure);
    } else {
      errors.push_back(std::move(*failure));
    }
  }
  auto* session = run.context.session;
  const bool leaves_power = session != nullptr && !session->energised().empty();
  // A lost interface does not come back by itself: the next line opens it again.
  if (!errors.empty() && errors.front().code == Errc::bus && session != nullptr) bus_.lose(*session);
  auto words = errors.empty() ? std::string() : show::abort_words(run.context, errors.front());
  auto value = result ? *result : Value();
  if (run.settings.shows_chinese() && !run.settings.names.empty()) put_into_chinese(run.context);
  name_axes_in(run.settings.names, run.context, value);
  return {.command = std::string(run.command->path),
          .settings = run.settings,
          .uses_bus = includes(run.command->needs, Needs::bus) || run.context.session != nullptr,
          .result = std::move(value),
          .errors = std::move(errors),
          .notices = std::move(run.context.notices),
          .leaves_power = leaves_power,
          .abort_words = std::move(words)};
}

Result<std::unique_ptr<session::RingEnd>> Shell::open_ring_end(const Settings& settings) {
  return bus_.open_ring_end(settings);
}

Result<std::unique_ptr<session::RegisterEnd>> Shell::open_register_end(const Settings& settings) {
  return bus_.open_register_end(settings);
}

/// A drive that stays energised only while servoctl is there is held until the user ends it.
int Shell::hold() {
  if (!bus_.must_go_on()) return 0;
  console_->note("notice: process data go on, and the drive stays as it is: Ctrl-C ends it\n");
  auto& session = *bus_.session();
  while (!cancelled() && bus_.must_go_on()) {
    const auto stepped = session.step(session.now() + std::chrono::milliseconds(250));
    for (const auto& notice : take_notices(nullptr, false))
      console_->note("notice: " + printable(notice) + "\n");
    if (!stepped) return report_error(stepped.error(), false);
  }
  if (cancelled()) return 0;
  return report_error(make_error(Errc::negative, "process data ended before you ended them",
                                 "the lines above say why; `status` shows the state of the slave"),
                      false);
}

int Shell::close(int code) {
  hear_last_line();
  if (bus_.holds_drives()) bus_.let_go();
  bus_.close();
  auto failure = bus_.take_trace_failure();
  if (!failure) failure = std::exchange(incomplete_trace_, std::nullopt);
  if (!failure) return code;
  const auto mine = report_error(*failure, false);
  return code == 0 ? mine : code;
}

int Shell::report_error(const Error& error, bool json, std::string_view command) {
  Settings settings;
  settings.json = json;
  return show(*console_, failed(error, std::move(settings), command));
}

}  // namespace servoctl::cli
