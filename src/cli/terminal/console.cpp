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

#include "base/printable.hpp"
#include "base/signal_wait.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/terminal/terminal_keys.hpp"
#include "report/catalogue.hpp"

namespace servoctl::cli {
namespace {

/// For who reads while a drive is energised and nothing is to be done about it.
constexpr Duration kPatience = std::chrono::seconds(2);

/// How lines for people begin, with what Chinese readers see there.
constexpr std::pair<std::string_view, std::string_view> kLeads[] = {
    {"error: ", "错误："}, {"  hint: ", "  建议："}, {"notice: ", "提示："}, {"warning: ", "警告："}};

/// The lines that begin so in Chinese; others are what somebody laid out, or asked, in Chinese already.
std::string remarks_in_chinese(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto end = text.find('\n');
    const auto line = text.substr(0, end);
    const auto* lead = std::find_if(std::begin(kLeads), std::end(kLeads),
                                    [&](const auto& one) { return line.starts_with(one.first); });
    if (lead == std::end(kLeads))
      out += line;
    else
      (out += lead->second) += report::in_chinese(line.substr(lead->first.size()));
    if (end == std::string_view::npos) break;
    out += '\n';
    text.remove_prefix(end + 1);
  }
  return out;
}

}  // namespace

void Console::out(std::string_view text) {
  const auto shown = printable_lines(text);
  write_out(shown);
  if (log_ == nullptr) return;
  log_->answered(shown);
  check_log();
}

void Console::err(std::string_view text) {
  const auto shown = printable_lines(chinese_ ? remarks_in_chinese(text) : std::string(text));
  write_err(shown);
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

void Console::check_log() {
  const auto failure = log_->take_failure();
  if (!failure) return;
  log_.reset();
  write_err("notice: " + printable(failure->message) + "; " + printable(failure->hint) + "\n");
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

/// Up to Enter, the end of the input, or a signal.
std::string StandardConsole::typed_line() const {
  std::string out;
  if (!line_is_there()) return out;
  for (int c = std::getchar(); c != EOF && c != '\n'; c = std::getchar()) out += static_cast<char>(c);
  if (std::feof(stdin) != 0 || std::ferror(stdin) != 0) std::clearerr(stdin);
  return out;
}

void StandardConsole::show(LiveOutput& output, std::string_view text) const {
  if (care_ == session::Care::none && !terminated()) return output.write(text);
  output.open();
  // What is to be done about the drive after a signal does not wait for who reads.
  const bool waits = care_ == session::Care::none || (care_ == session::Care::energised && !interrupted());
  output.offer(text, waits ? kPatience : Duration::zero());
}

void StandardConsole::make_room() {
  if (view_ != nullptr) view_->step_aside();
}

void StandardConsole::write_out(std::string_view text) {
  make_room();
  show(out_, text);
}

void StandardConsole::write_err(std::string_view text) {
  make_room();
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

void StandardConsole::finish() {
  for (auto* output : {&out_, &err_}) {
    show(*output, {});
    output->give_up();
  }
}

void StandardConsole::show_progress(std::string_view line) {
  if (::isatty(STDERR_FILENO) == 1 && !is_quiet()) write_err("\r\033[K" + printable(line));
}

bool StandardConsole::ask(std::string_view question) {
  if (!can_ask()) return false;
  ::tcflush(STDIN_FILENO, TCIFLUSH);  // What was typed before the question is no answer to it.
  err(std::string(question) + " [y/N] ");
  const auto answer = typed_line();
  log_typed(answer);
  return answer == "y" || answer == "Y" || answer == "yes";
}

void StandardConsole::pause(std::string_view text) {
  (void)::tcflush(STDIN_FILENO, TCIFLUSH);  // What was typed before the text is no answer to it.
  err(std::string(text) + " [Enter] ");
  log_typed(typed_line());
}

bool StandardConsole::can_ask() const { return ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1; }

std::unique_ptr<command::Keys> StandardConsole::open_keys() {
  return can_ask() ? TerminalKeys::open(STDIN_FILENO) : nullptr;
}

std::unique_ptr<show::LiveView> StandardConsole::open_view(const show::LiveView::Layout& layout) {
  if (view_ != nullptr || screen_size().rows == 0) return nullptr;
  auto view =
      std::make_unique<TerminalView>(layout,
                                     Screen{.write = [this](std::string_view text) { show(out_, text); },
                                            .size = [this] { return screen_size(); },
                                            .closed = [this] { view_ = nullptr; }},
                                     open_keys());
  view->set_chinese(chinese());
  view_ = view.get();
  return view;
}

Screen::Size StandardConsole::screen_size() const {
  winsize size{};
  if (!shows_output_ || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return {};
  return {size.ws_col, size.ws_row};
}

std::size_t StandardConsole::width() const { return screen_size().columns; }
std::size_t StandardConsole::height() const { return screen_size().rows; }

}  // namespace servoctl::cli
