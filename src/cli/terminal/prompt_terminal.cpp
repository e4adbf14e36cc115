#include "cli/terminal/prompt_terminal.hpp"

#include <cstdlib>
#include <utility>

#include "cli/terminal/fitted.hpp"
#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

/// Of xterm, DECSET 2004: what is pasted stands between marks.
constexpr std::string_view kMarkPastes = "\x1B[?2004h";
constexpr std::string_view kMarkNoPastes = "\x1B[?2004l";

}  // namespace

bool moves_cursor() {
  const char* term = std::getenv("TERM");
  return term != nullptr && *term != '\0' && std::string_view(term) != "dumb";
}

PromptTerminal::PromptTerminal(Console& console)
    : console_(&console), edits_(shows_output_ && moves_cursor()) {}

void PromptTerminal::begin() {
  console_->set_waits_for_none(true);
  if (!edits_) return;
  mode_.enter();
  note_resizes(true);
  keep_last_words(kMarkNoPastes);
  console_->draw(kMarkPastes);
  marks_ = true;
  resumed_ = times_resumed();
  size_ = {console_->width(), console_->height()};
}

void PromptTerminal::pause() {
  note_resizes(false);
  mode_.leave();
  console_->set_waits_for_none(false);
}

void PromptTerminal::leave() {
  if (std::exchange(marks_, false)) console_->draw(kMarkNoPastes);
  keep_last_words("");
  pause();
}

PromptTerminal::Change PromptTerminal::take_change() {
  if (!edits_) return Change::none;
  const auto times = times_resumed();
  const bool renewed = mode_.renew();
  if (std::exchange(resumed_, times) != times || renewed) {
    console_->draw(kMarkPastes);
    return Change::stopped;
  }
  const Screen::Size now{console_->width(), console_->height()};
  return std::exchange(size_, now) == now ? Change::none : Change::size;
}

void PromptTerminal::say(std::string_view text) {
  if (shows_output_)
    console_->out(fitted(text, console_->width()));
  else
    console_->err(fitted(text, console_->err_width()));
}

}  // namespace servoctl::cli
