#include "cli/running_line.hpp"

#include <fmt/format.h>

#include "base/printable.hpp"
#include "cli/batch/setting_lines.hpp"
#include "cli/shell.hpp"
#include "session/modbus_network.hpp"
#include "session/serve_registers.hpp"
#include "session/serve_ring.hpp"

namespace servoctl::cli {

RunningLine::RunningLine(Shell& shell, const Settings& settings, command::Context& context)
    : shell_(&shell), settings_(&settings), context_(&context) {
  context.audience = this;
  context.front_end = this;
}

Result<void> RunningLine::confirm(std::string_view question) {
  if (settings_->yes) return {};
  const auto turn = shell_->take_turn();
  auto& console = shell_->console();
  const auto shown = printable(settings_->names.in(question));
  const auto asked = printable(settings_->names.in(console.in_language(question)));
  if (!console.can_ask())
    return fail(Errc::refused, fmt::format("confirmation needed: {}", shown), "add --yes to confirm");
  if (console.ask(asked)) return {};
  return fail(Errc::refused, "not confirmed; nothing was sent");
}

void RunningLine::emit(const report::Record& sample, std::string_view line) {
  const auto turn = shell_->take_turn();
  const auto& names = settings_->names;
  if (settings_->samples && names.empty()) {
    shell_->console().out(report::to_json(sample) + "\n");
  } else if (settings_->samples) {
    auto named = sample;
    names.put_into(named);
    shell_->console().out(report::to_json(named) + "\n");
  } else if (!settings_->json && !line.empty()) {
    const auto shown = shell_->console().in_language(line);
    shell_->console().out(printable(names.empty() ? shown : names.in(shown)) + "\n");
  }
}

void RunningLine::write(std::string_view lines) {
  const auto turn = shell_->take_turn();
  shell_->console().out(lines);
}

void RunningLine::tell(std::string_view text) {
  const auto turn = shell_->take_turn();
  shell_->end_progress();
  // What a question is about stands before it.
  if (!settings_->quiet || !settings_->yes)
    shell_->console().err(settings_->names.in(shell_->console().in_language(text)));
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
  return shell_->open(on_bus(cabinet, *settings_, bus).settings);
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
  if (auto* line = context_->session->modbus(); line != nullptr && profile != nullptr)
    for (const auto node : nodes) line->learn(node, profile->rules.modbus);
  FamilyGate gate(
      *context_->session,
      {.folders = shell_->drive_folders(), .force = settings_->force_family, .dry_run = settings_->dry_run},
      context_->notices);
  return gate.hold(nodes, profile, weight);
}

Result<const drive::Profile*> RunningLine::family(const std::string& name) {
  const auto turn = shell_->take_turn();
  return shell_->profile(name);
}

std::vector<std::uint8_t> RunningLine::energised_on(std::string_view url) const {
  const auto turn = shell_->take_turn();
  return shell_->energised_on(url);
}

std::unique_ptr<command::Keys> RunningLine::open_keys() { return shell_->console().open_keys(); }

Result<std::vector<settings::SettingLine>> RunningLine::setting_lines(std::string_view text,
                                                                      const std::string& file) {
  return cli::setting_lines(*shell_, text, file);
}

}  // namespace servoctl::cli
