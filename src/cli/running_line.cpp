#include "cli/running_line.hpp"

#include "base/format.hpp"
#include "base/printable.hpp"
#include "cli/batch/setting_lines.hpp"
#include "cli/heard_starts.hpp"
#include "cli/shell.hpp"
#include "cli/terminal/fitted.hpp"
#include "session/modbus_network.hpp"
#include "session/serve_registers.hpp"
#include "session/serve_ring.hpp"
#include "show/chinese_names.hpp"

namespace servoctl::cli {

RunningLine::RunningLine(Shell& shell, const Settings& settings, command::Context& context)
    : shell_(&shell), settings_(&settings), context_(&context) {
  context.audience = this;
  context.front_end = this;
}

const report::Names* RunningLine::chinese_names() {
  if (!settings_->shows_chinese()) return nullptr;
  if (context_->profile != nullptr) families_.insert(context_->profile);
  if (families_.empty()) return nullptr;
  for (const auto* family : families_)
    if (named_.insert(family).second) names_.merge(show::chinese_names(*family));
  return &names_;
}

std::string RunningLine::in_language(std::string_view text) {
  return shell_->console().chinese() ? report::in_chinese(text, chinese_names()) : std::string(text);
}

Result<void> RunningLine::confirm(std::string_view question) {
  if (settings_->yes) return {};
  const auto turn = shell_->take_turn();
  auto& console = shell_->console();
  const auto shown = printable(settings_->names.in(question));
  const auto asked = printable(settings_->names.in(in_language(question)));
  shell_->end_progress();
  if (!console.can_ask())
    return fail(Errc::refused, message("confirmation needed: {}", shown), "add --yes to confirm");
  const HeardStarts before(shell_->sessions());
  if (console.ask(asked)) return hold_nodes(before);
  return fail(shell_->cancelled() ? Errc::interrupted : Errc::refused, "not confirmed; nothing was changed");
}

/// What was looked at before the question is what the answer is about.
Result<void> RunningLine::hold_nodes(const HeardStarts& before) const {
  auto nodes = context_->nodes;
  if (!nodes.empty()) nodes.insert(nodes.end(), context_->free_nodes.begin(), context_->free_nodes.end());
  const auto node = before.started_since(nodes);
  if (!node) return {};
  return fail(drive_error(Errc::refused, *node,
                          "it has started while the question waited, and may be another drive, or hold other "
                          "values, than the question was about",
                          "nothing was changed; give the line again, which looks at it anew"));
}

void RunningLine::emit(const report::Record& sample, std::string_view line) {
  const auto turn = shell_->take_turn();
  const auto& names = settings_->names;
  shell_->note_output();
  if (settings_->samples && names.empty()) {
    shell_->console().json(report::to_json(sample) + "\n");
  } else if (settings_->samples) {
    auto named = sample;
    names.put_into(named);
    shell_->console().json(report::to_json(named) + "\n");
  } else if (!settings_->json && !line.empty()) {
    auto& console = shell_->console();
    const auto shown = in_language(line);
    console.out(fitted(printable(names.empty() ? shown : names.in(shown)), console.width()) + "\n");
  }
}

void RunningLine::write(std::string_view lines) {
  const auto turn = shell_->take_turn();
  shell_->note_output();
  if (settings_->samples) return shell_->console().json(lines);
  shell_->console().out(fitted(lines, shell_->console().width()));
}

void RunningLine::tell(std::string_view text) {
  const auto turn = shell_->take_turn();
  shell_->end_progress();
  // What a question is about stands before it.
  if (!settings_->quiet || !settings_->yes) shell_->console().err(settings_->names.in(in_language(text)));
}

void RunningLine::show_progress(std::string_view line, TimePoint now) {
  const auto turn = shell_->take_turn();
  shell_->show_progress(line, now);
}

void RunningLine::show_share(double share, TimePoint begin, TimePoint now) {
  const auto turn = shell_->take_turn();
  shell_->show_share(share, begin, now);
}

std::size_t RunningLine::width() const { return shell_->console().width(); }

std::unique_ptr<show::LiveView> RunningLine::open_view(const show::LiveView::Layout& layout) {
  const auto turn = shell_->take_turn();
  if (settings_->json || settings_->samples) return nullptr;
  auto view = shell_->console().open_view(layout);
  if (view) view->set_names(settings_->names);
  return view;
}

bool RunningLine::is_gone() const {
  const auto turn = shell_->take_turn();
  return shell_->console().output_lost();
}

Result<session::Session*> RunningLine::open_bus() {
  const auto turn = shell_->take_turn();
  const auto opened = shell_->open(*settings_);
  if (opened) context_->session = *opened;
  return opened;
}

Result<const cabinet::Cabinet*> RunningLine::cabinet() {
  const auto turn = shell_->take_turn();
  if (settings_->force_family)
    return fail(Errc::usage, "--force-family is for lines that name a family with -d",
                "the cabinet file says what each axis is: change its `family` there");
  auto found = shell_->cabinet(*settings_);
  if (found && *found == nullptr)
    return fail(Errc::usage, "there is no cabinet file",
                "name one with --cabinet, or go to its folder; `cabinet init` makes one");
  return found;
}

Result<session::Session*> RunningLine::open_bus(const cabinet::Cabinet& cabinet, const cabinet::Bus& bus) {
  auto opened = shell_->open(on_bus(cabinet, *settings_, bus).settings);
  if (!opened) return opened;
  for (const auto& axis : cabinet.axes) {
    if (axis.bus != bus.name) continue;
    const std::uint8_t node[] = {axis.node};
    if (const auto profile = family(axis.family)) shell_->note_family(**opened, node, *profile);
  }
  return opened;
}

Result<std::unique_ptr<session::RegisterEnd>> RunningLine::open_register_end() {
  return shell_->open_register_end(*settings_);
}

Result<std::unique_ptr<session::RingEnd>> RunningLine::open_ring_end() {
  return shell_->open_ring_end(*settings_);
}

Result<void> RunningLine::hold_family(std::span<const std::uint8_t> nodes, const drive::Profile* profile,
                                      bool changes) {
  return hold_family(nodes, profile, changes ? FamilyGate::Weight::changes : FamilyGate::Weight::answers);
}

Result<void> RunningLine::hold_family(std::span<const std::uint8_t> nodes, const drive::Profile* profile,
                                      FamilyGate::Weight weight) {
  shell_->note_family(*context_->session, nodes, profile);
  if (auto* line = context_->session->modbus(); line != nullptr && profile != nullptr)
    for (const auto node : nodes) line->learn(node, profile->rules.modbus);
  FamilyGate gate(*context_->session,
                  {.folders = shell_->drive_folders(),
                   .force = settings_->force_family,
                   .dry_run = settings_->dry_run,
                   .waits = waits_,
                   .names = settings_->names},
                  context_->notices);
  return gate.hold(nodes, profile, weight);
}

Result<const drive::Profile*> RunningLine::family(const std::string& name) {
  const auto turn = shell_->take_turn();
  auto loaded = shell_->profile(name);
  if (loaded) families_.insert(*loaded);
  return loaded;
}

session::Protection::Hold RunningLine::protect() { return shell_->protect(session::Care::unsettled); }

void RunningLine::wait_for_no_reader() {
  const auto turn = shell_->take_turn();
  shell_->console().set_waits_for_none(true);
}

std::vector<std::uint8_t> RunningLine::energised_on(std::string_view url) const {
  const auto turn = shell_->take_turn();
  return shell_->energised_on(url);
}

bool RunningLine::has_adapter(std::string_view adapter) const {
  const auto turn = shell_->take_turn();
  return shell_->has_adapter(adapter);
}

Result<void> RunningLine::release_adapter(std::string_view adapter) {
  const auto turn = shell_->take_turn();
  return shell_->release_adapter(adapter);
}

std::unique_ptr<command::Keys> RunningLine::open_keys() { return shell_->console().open_keys(); }

Result<std::vector<settings::SettingLine>> RunningLine::setting_lines(std::string_view text,
                                                                      const std::string& file) {
  return cli::setting_lines(*shell_, text, file);
}

}  // namespace servoctl::cli
