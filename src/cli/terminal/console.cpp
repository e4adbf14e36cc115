#include "cli/terminal/console.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/lines.hpp"
#include "base/printable.hpp"
#include "base/signal_wait.hpp"
#include "base/text.hpp"
#include "cli/terminal/ascii_form.hpp"
#include "cli/terminal/fitted.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/terminal/terminal_keys.hpp"
#include "report/catalogue.hpp"

namespace servoctl::cli {
namespace {

/// For who reads while a drive is energised and nothing is to be done about it.
constexpr Duration kPatience = std::chrono::seconds(2);

/// How lines for people begin.
constexpr std::string_view kLeads[] = {"error: ", "  hint: ", "notice: ", "warning: ", "detail: "};

/// The lines that begin so in Chinese; others are what somebody laid out, or asked, in Chinese already.
std::string remarks_in_chinese(std::string_view text) {
  return change_lines(text, [](std::string_view line) {
    const auto* lead = std::find_if(std::begin(kLeads), std::end(kLeads),
                                    [&](const auto& one) { return line.starts_with(one); });
    return lead == std::end(kLeads)
               ? std::string(line)
               : std::string(report::chinese_word(*lead)) + report::in_chinese(line.substr(lead->size()));
  });
}

}  // namespace

std::string Console::dressed(std::string_view text, int descriptor) const {
  // Chinese has no ASCII: who wants it gets UTF-8.
  auto out = is_ascii() ? ascii_form(text) : std::string(text);
  return has_colours(colour_, descriptor) ? coloured(out) : out;
}

/// What is not printable stands in JSON as an escape.
void Console::json(std::string_view text) {
  write_out(text);
  if (log_ == nullptr) return;
  log_->answered(text);
  check_log();
}

std::string Console::as_written(std::string_view text) const {
  return dressed(printable_lines(text), STDOUT_FILENO);
}

void Console::out(std::string_view text) {
  const auto shown = printable_lines(text);
  write_out(dressed(shown, STDOUT_FILENO));
  if (log_ == nullptr) return;
  log_->answered(shown);
  check_log();
}

void Console::err(std::string_view text) {
  if (text.empty()) return;
  const auto shown = printable_lines(chinese_ ? remarks_in_chinese(text) : std::string(text));
  write_err(dressed(fitted(shown, err_width()), STDERR_FILENO));
  if (log_ == nullptr) return;
  log_->answered(shown);
  check_log();
}

std::string Console::in_language(std::string_view text) const {
  return chinese_ ? report::in_chinese(text) : std::string(text);
}

void Console::log_typed(std::string_view line) {
  if (log_ == nullptr) return;
  log_->typed(printable(line));
  check_log();
}

void Console::log_unseen(std::string_view text) {
  if (log_ == nullptr || text.empty()) return;
  log_->answered(printable_lines(text));
  check_log();
}

void Console::check_log() {
  const auto failure = log_->take_failure();
  if (!failure) return;
  log_.reset();
  write_err("notice: " + printable(failure->message.text()) + "; " + printable(failure->hint.text()) + "\n");
}

/// Waits until a line was typed; false after Ctrl-C.
bool StandardConsole::line_is_there() const {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!interrupted()) {
    const auto time = serve();
    const auto longest = time == Duration::max() ? std::nullopt : std::optional(time);
    if (wait_or_signal(std::span(&input, 1), longest) > 0) return true;
  }
  return false;
}

/// Up to Enter. Nothing where a signal or the end of the input (Ctrl-D) came first: the line of the question
/// is ended then.
std::string StandardConsole::typed_line() {
  std::string out;
  int c = EOF;
  if (line_is_there())
    for (c = std::getchar(); c != EOF && c != '\n'; c = std::getchar()) out += static_cast<char>(c);
  if (std::feof(stdin) != 0 || std::ferror(stdin) != 0) std::clearerr(stdin);
  if (c == '\n') return out;
  write_err("\n");
  return {};
}

void StandardConsole::show(LiveOutput& output, std::string_view text) const {
  const auto longest = patience(output);
  if (!longest) return output.write(text);
  output.open();
  output.offer(text, *longest, pulse());
}

std::optional<Duration> StandardConsole::patience(const LiveOutput& output) const {
  if (waits_for_none_) return Duration::zero();
  const bool presses_now = presses();
  if (care_ == session::Care::none && !terminated() && !presses_now) return std::nullopt;
  // What is to be done about the drive after a signal does not wait for who reads.
  if (care_ != session::Care::none && (care_ != session::Care::energised || interrupted()))
    return Duration::zero();
  const bool is_terminal = &output == &out_ ? shows_output_ : ::isatty(STDERR_FILENO) == 1;
  return presses_now && is_terminal ? Duration::zero() : kPatience;
}

void StandardConsole::make_room() {
  if (view_ != nullptr) view_->step_aside();
}

void StandardConsole::write_out(std::string_view text) {
  has_shown_ = true;
  make_room();
  const auto shown = shows_output_ ? progress_ : std::string();
  if (shows_output_) wipe_progress();
  show(out_, text);
  if (!shown.empty() && text.ends_with('\n')) show_progress(shown);
}

void StandardConsole::write_err(std::string_view text) {
  make_room();
  wipe_progress();
  show(err_, text);
}

void StandardConsole::set_care(session::Care care) {
  const bool was_live = std::exchange(care_, care) != session::Care::none;
  const bool is_live = care != session::Care::none;
  if (is_live == was_live) return;
  for (auto* output : {&out_, &err_}) {
    if (is_live)
      output->open();
    else
      output->close();
  }
}

void StandardConsole::set_waits_for_none(bool none) {
  waits_for_none_ = none;
  for (auto* output : {&out_, &err_}) {
    // What Ctrl-C kept a line from writing is not wanted any more.
    if (none) output->forget_signal();
    if (none) output->open();
  }
}

bool StandardConsole::is_behind() {
  for (auto* output : {&out_, &err_})
    if (output->is_waiting()) output->offer({});
  return out_.is_waiting() || err_.is_waiting();
}

void StandardConsole::wait_for_reader() {
  for (auto* output : {&out_, &err_}) show(*output, {});
}

void StandardConsole::finish() {
  wait_for_reader();
  for (auto* output : {&out_, &err_}) output->give_up();
}

bool StandardConsole::shows_progress() const {
  if (::isatty(STDERR_FILENO) != 1 || is_quiet() || asks_ || view_ != nullptr || err_.is_waiting())
    return false;
  // A terminal that was halted (Ctrl-S) takes nothing.
  pollfd room{STDERR_FILENO, POLLOUT, 0};
  return ::poll(&room, 1, 0) == 1 && (room.revents & POLLOUT) != 0;
}

void StandardConsole::show_progress(std::string_view line) {
  if (line.empty()) return wipe_progress();
  if (!shows_progress()) return;
  const auto shown = dressed(printable(line), STDERR_FILENO);
  progress_ = line;
  show(err_, "\r\033[K" + (err_width() > 1 ? clip(shown, err_width() - 1) : shown));
}

void StandardConsole::wipe_progress() {
  if (!std::exchange(progress_, {}).empty()) show(err_, "\r\033[K");
}

bool StandardConsole::ask(std::string_view question) {
  if (!can_ask()) return false;
  ::tcflush(STDIN_FILENO, TCIFLUSH);  // What was typed before the question is no answer to it.
  err(std::string(question) + " [y/N] ");
  asks_ = true;
  const auto answer = typed_line();
  asks_ = false;
  log_typed(answer);
  return answer == "y" || answer == "Y" || answer == "yes";
}

void StandardConsole::pause(std::string_view text) {
  (void)::tcflush(STDIN_FILENO, TCIFLUSH);  // What was typed before the text is no answer to it.
  err(std::string(text) + " [Enter] ");
  asks_ = true;
  const auto answer = typed_line();
  asks_ = false;
  log_typed(answer);
}

bool StandardConsole::can_ask() const { return ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1; }

std::unique_ptr<command::Keys> StandardConsole::open_keys() {
  return can_ask() ? TerminalKeys::open(STDIN_FILENO) : nullptr;
}

std::unique_ptr<show::LiveView> StandardConsole::open_view(const show::LiveView::Layout& layout) {
  if (view_ != nullptr || screen_size().rows == 0) return nullptr;
  wipe_progress();
  auto view =
      std::make_unique<TerminalView>(layout,
                                     Screen{.write = [this](std::string_view text) { show(out_, text); },
                                            .size = [this] { return screen_size(); },
                                            .closed = [this] { view_ = nullptr; }},
                                     open_keys());
  view->set_chinese(chinese());
  view->set_ascii(is_ascii());
  view_ = view.get();
  has_shown_ = true;
  return view;
}

Screen::Size StandardConsole::screen_size() const {
  winsize size{};
  if (!shows_output_ || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return {};
  return {size.ws_col, size.ws_row};
}

std::size_t StandardConsole::err_width() const {
  winsize size{};
  return ::isatty(STDERR_FILENO) == 1 && ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}
std::size_t StandardConsole::width() const { return screen_size().columns; }
std::size_t StandardConsole::height() const { return screen_size().rows; }

}  // namespace servoctl::cli
