#pragma once

#include <unistd.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/time.hpp"
#include "cli/line_log.hpp"
#include "cli/terminal/colour.hpp"
#include "cli/terminal/live_output.hpp"
#include "cli/terminal/terminal_view.hpp"
#include "command/keys.hpp"
#include "session/protection.hpp"
#include "show/live_view.hpp"

namespace servoctl::cli {

/// Where a front end puts its text and asks its questions: the terminal, or a record of a test.
class Console {
 public:
  Console() = default;
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;
  virtual ~Console() = default;

  /// Data, as people read it. Whatever it holds, nothing but printable_lines() of it leaves the program.
  void out(std::string_view text);
  /// What out() would write.
  std::string as_written(std::string_view text) const;
  /// Data for programs: UTF-8 whatever the locale, and no colours.
  void json(std::string_view text);
  /// Errors, warnings, questions; as out().
  void err(std::string_view text);
  /// A notice, or how far something has come: nothing with --quiet.
  void note(std::string_view text) {
    if (!quiet_) err(text);
  }
  void set_quiet(bool quiet) { quiet_ = quiet; }
  bool is_quiet() const { return quiet_; }
  /// What the program does, in a line, for --verbose. Who makes a text for it asks is_verbose() first.
  void detail(std::string_view text) {
    if (verbose_) err("detail: " + std::string(text) + "\n");
  }
  void set_verbose(bool verbose) { verbose_ = verbose; }
  bool is_verbose() const { return verbose_; }
  /// Whether who reads wants Chinese: what err() is given as `error: …`, `  hint: …`, `notice: …`,
  /// `warning: …` or `detail: …`, what a table on the terminal says and how far something has come is put
  /// into it.
  void set_chinese(bool chinese) { chinese_ = chinese; }
  bool chinese() const { return chinese_; }
  /// Which text has colours; and that text in English is ASCII, as the locale wants it.
  void set_colour(Colour colour) { colour_ = colour; }
  Colour colour() const { return colour_; }
  void set_ascii(bool ascii) { ascii_ = ascii; }
  bool is_ascii() const { return ascii_ && !chinese_; }
  /// The text in the language of who reads.
  std::string in_language(std::string_view text) const;
  /// Text of the line that is being typed, with what moves the cursor; only where somebody looks.
  virtual void draw(std::string_view text) { (void)text; }
  /// Shows this line in place of the one shown before; an empty one wipes it. Only where somebody looks, and
  /// below whatever else is shown.
  virtual void show_progress(std::string_view line) = 0;
  /// Asks a yes-or-no question; false if there is nobody to ask or the answer is no.
  virtual bool ask(std::string_view question) = 0;
  /// Shows the text and waits for Enter; only where can_ask().
  virtual void pause(std::string_view text) = 0;
  virtual bool can_ask() const = 0;       ///< Whether there is a person at a terminal.
  virtual std::size_t width() const = 0;  ///< Columns of the terminal text goes to; 0: no terminal.
  virtual std::size_t err_width() const { return width(); }  ///< The same of what err() is given.
  virtual std::size_t height() const { return 0; }           ///< Rows of it.
  /// The keys of the terminal as they are pressed, until the answer is destroyed; null where there is none.
  virtual std::unique_ptr<command::Keys> open_keys() { return nullptr; }
  /// A table on the terminal, until the answer is destroyed; null where text goes somewhere else.
  virtual std::unique_ptr<show::LiveView> open_view(const show::LiveView::Layout& layout) {
    (void)layout;
    return nullptr;
  }
  /// Whether data can no longer be written: the reader has gone.
  virtual bool output_lost() const { return false; }
  /// Told what would be left alone if nobody read what is shown: who reads is not waited for while a drive is
  /// guarded, and two seconds at most while one is energised.
  virtual void set_care(session::Care care) { (void)care; }
  /// While it is set, who reads is waited for not at all: what is written waits for them. A person types a
  /// line, and buses are served meanwhile.
  virtual void set_waits_for_none(bool none) { (void)none; }
  /// Waits for who reads as long as it would for the next text.
  virtual void wait_for_reader() {}
  /// Passes on what waits for who reads; whether something still does.
  virtual bool is_behind() { return false; }
  /// How many texts of out() were left out since the last call, because their reader was too slow.
  virtual std::size_t take_left_out() { return 0; }
  /// The same for err().
  virtual std::size_t take_untold() { return 0; }

  /// From now on all of it, and what is typed, goes into this log as well; null: into none. A log that fails
  /// is told, and given up.
  void set_log(std::unique_ptr<LineLog> log) { log_ = std::move(log); }
  const LineLog* log() const { return log_.get(); }
  /// A line, or the answer to a question.
  void log_typed(std::string_view line);
  /// What is answered and not shown, because who read has seen enough.
  void log_unseen(std::string_view text);

  /// What is done while the user is waited for; it answers how long it can be left alone. May be empty.
  void set_service(std::function<Duration()> service) { service_ = std::move(service); }
  /// Answers whether what is sent regularly would fail to be sent while somebody is waited for who does not
  /// read: a terminal is not waited for then, and others two seconds. May be empty.
  void set_presses(std::function<bool()> presses) { presses_ = std::move(presses); }
  /// Sends what is sent regularly and is due while a reader is waited for; answers how long it can be left
  /// alone, nothing where it cannot be sent from there: then nobody is waited for. May be empty.
  void set_pulse(std::function<Duration()> pulse) { pulse_ = std::move(pulse); }

 protected:
  virtual void write_out(std::string_view text) = 0;
  virtual void write_err(std::string_view text) = 0;
  /// As the terminal and its locale want it: `descriptor` is where it goes.
  std::string dressed(std::string_view text, int descriptor) const;
  Duration serve() const { return service_ ? service_() : Duration::max(); }
  bool presses() const { return presses_ && presses_(); }
  const std::function<Duration()>& pulse() const { return pulse_; }

 private:
  void check_log();

  std::function<Duration()> service_;
  std::function<bool()> presses_;
  std::function<Duration()> pulse_;
  std::unique_ptr<LineLog> log_;
  bool quiet_ = false;
  bool verbose_ = false;
  bool chinese_ = false;
  bool ascii_ = false;
  Colour colour_ = Colour::automatic;
};

/// Standard streams of the process.
class StandardConsole final : public Console {
 public:
  void draw(std::string_view text) override {
    has_shown_ = true;
    show(out_, text);
  }
  void show_progress(std::string_view line) override;
  bool ask(std::string_view question) override;
  void pause(std::string_view text) override;
  bool can_ask() const override;
  std::size_t width() const override;
  std::size_t err_width() const override;
  std::size_t height() const override;
  std::unique_ptr<command::Keys> open_keys() override;
  std::unique_ptr<show::LiveView> open_view(const show::LiveView::Layout& layout) override;
  bool output_lost() const override { return write_error() != 0; }
  void set_care(session::Care care) override;
  void set_waits_for_none(bool none) override;
  void wait_for_reader() override;
  bool is_behind() override;
  std::size_t take_left_out() override { return out_.take_left_out(); }
  std::size_t take_untold() override { return err_.take_left_out(); }

  /// Whether anything of the output was shown already.
  bool has_shown() const { return has_shown_; }
  /// Writes what still waits for its reader; the last call.
  void finish();
  /// The first error (errno) that kept data from being written; 0 when all of it was.
  int write_error() const { return out_.error(); }

 protected:
  void write_out(std::string_view text) override;
  void write_err(std::string_view text) override;

 private:
  /// Nothing where text goes somewhere else.
  Screen::Size screen_size() const;
  /// Text stands above a table that is on the screen.
  void make_room();
  void wipe_progress();
  /// Whether a line that goes on can be shown: a terminal that takes it at once, and nobody who is asked.
  bool shows_progress() const;
  bool line_is_there() const;
  std::string typed_line();
  void show(LiveOutput& output, std::string_view text) const;
  /// How long who reads is waited for; empty: as long as they like.
  std::optional<Duration> patience(const LiveOutput& output) const;

  session::Care care_ = session::Care::none;
  bool waits_for_none_ = false;
  bool asks_ = false;
  std::string progress_;  ///< That is on the screen; empty: none.
  bool has_shown_ = false;
  bool shows_output_ = ::isatty(STDOUT_FILENO) == 1;
  TerminalView* view_ = nullptr;
  LiveOutput out_{1};
  LiveOutput err_{2};
};

}  // namespace servoctl::cli
