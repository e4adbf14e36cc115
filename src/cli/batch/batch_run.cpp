#include "cli/batch/batch_run.hpp"

#include <poll.h>

#include <fmt/format.h>
#include <utility>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/signal_wait.hpp"
#include "base/timespec.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "session/open_bus.hpp"
#include "session/stretch.hpp"
#include "show/records.hpp"

namespace servoctl::cli {
namespace {

using report::Value;

class BatchRun {
 public:
  BatchRun(Shell& shell, std::span<const Step> steps, const std::string& file)
      : shell_(&shell), file_(&file), settings_(shell.defaults()), count_(steps.size()) {}

  /// False when the run ends here.
  bool take(const Step& step) {
    last_step_ = &step;
    if (shell_->cancelled()) return false;
    auto outcome = perform(step);
    const bool ok = outcome.errors.empty();
    // Ctrl-C ends the run whatever holds for failures.
    const bool stopped = !ok && outcome.errors.front().code == Errc::interrupted;
    ++(ok ? done_ : failed_);
    if (!ok && (!first_error_ || stopped)) first_error_ = in_line(step, outcome.errors.front());
    ended_ = stopped || !(ok || step.goes_on);
    // Whoever does not read what went wrong does not hold it up.
    if (ended_ || shell_->cancelled()) let_go();
    tell(step, std::move(outcome));
    return !is_exit(step.words) && !ended_;
  }

  /// A signal that came at any time ends the run as an interrupted one, also where no line is left.
  void hear_signal() {
    if (ended_ || last_step_ == nullptr || !shell_->cancelled()) return;
    ended_ = true;
    let_go();
    first_error_ = in_line(*last_step_, interrupted_error());
    if (!settings_.json) show_remarks(shell_->console(), failed(*first_error_, settings_));
  }

  bool has_failed() const { return first_error_.has_value(); }

  /// What cannot be let go is told once.
  void let_go() {
    if (!std::exchange(has_let_go_, true)) shell_->let_go();
  }

  int finish() {
    const auto left = count_ - done_ - failed_;
    if (!settings_.json) {
      const auto said = formatted("{}: {} of {} lines done", printable(*file_), done_, count_) +
                        (failed_ > 0 ? formatted(", {} failed", failed_) : "") +
                        (left > 0 ? formatted(", {} not run", left) : "");
      shell_->console().note(shell_->console().in_language(said) + "\n");
      return first_error_ ? exit_code(first_error_->code) : 0;
    }
    report::Record result;
    result.push_back({"lines", settings_.samples ? Value() : Value(std::move(records_))});
    result.push_back({"summary", report::Record{{"lines", count_}, {"done", done_}, {"failed", failed_}}});
    Outcome outcome{.command = "run", .settings = settings_, .uses_bus = true, .result = std::move(result)};
    if (first_error_) outcome.errors.push_back(std::move(*first_error_));
    return show(shell_->console(), outcome);
  }

 private:
  Error in_line(const Step& step, Error error) const {
    return at_line(*file_, step.line, in_round(step.round, std::move(error)));
  }

  Error interrupted_error() const {
    return make_error(Errc::interrupted, "interrupted",
                      done_ + failed_ < count_ ? "earlier lines were run, later ones were not"
                                               : "all lines were run; the signal came in the last one");
  }

  Outcome perform(const Step& step) {
    switch (step.kind) {
      case Step::Kind::command: return command(step);
      case Step::Kind::expect: return expectation(step);
      case Step::Kind::pause: return pause(step);
      case Step::Kind::wait: return wait(step);
    }
    return {};
  }

  Outcome command(const Step& step) {
    if (is_exit(step.words)) return {.command = "exit", .settings = shell_->defaults()};
    if (auto outcome = choose(*shell_, step.words)) return std::move(*outcome);
    auto outcome = shell_->perform(step.words);
    last_ = outcome.result;
    return outcome;
  }

  Outcome expectation(const Step& step) const {
    if (const auto met = expect(step.expression, last_); !met)
      return failed(met.error(), shell_->defaults(), "expect");
    return {.command = "expect", .settings = shell_->defaults()};
  }

  Outcome pause(const Step& step) {
    Outcome out{.command = "pause", .settings = shell_->defaults()};
    const auto text = formatted("{}", fmt::join(step.words, " "));
    if (!shell_->console().can_ask()) {
      out.notices.push_back("no terminal, pause skipped: " + Message(as_it_is(text)));
      return out;
    }
    shell_->console().pause(text);
    if (shell_->cancelled()) return failed(interrupted_error(), shell_->defaults(), "pause");
    return out;
  }

  /// Axes of a cabinet are on buses of their own, which stay as they are and are all listened to.
  Outcome wait_on_all(Duration length) {
    Outcome out{.command = "wait", .settings = shell_->defaults()};
    const auto lost = [&out](const Error& error) { out.errors.push_back(error); };
    const auto end = steady_now() + length;
    while (out.errors.empty() && steady_now() < end && !shell_->cancelled()) {
      pollfd nothing{-1, POLLIN, 0};
      (void)shell_->wait_for(nothing, left_until(end), lost);
    }
    for (auto& notice : shell_->take_notices(profile(), shell_->defaults().chinese))
      out.notices.push_back(std::move(notice));
    if (shell_->cancelled()) out.errors.push_back(interrupted_error());
    return out;
  }

  bool waits_on_all() const {
    const auto* const used = shell_->session();
    const auto& bus = shell_->defaults().bus;
    return bus.empty() ||
           (used != nullptr && session::canonical_url(used->url()) != session::canonical_url(bus));
  }

  Outcome wait(const Step& step) {
    if (waits_on_all()) return wait_on_all(step.duration);
    const auto opened = shell_->open(shell_->defaults());
    if (!opened) return failed(opened.error(), shell_->defaults(), "wait");
    auto& session = **opened;
    const Shell::ShownWait shown(*shell_);
    const session::Stretch stretch(session, session.now() + step.duration);
    const auto waited = session.wait([] { return false; }, stretch.end());
    Outcome out{.command = "wait", .settings = shell_->defaults()};
    out.notices = shell_->take_notices(profile(), shell_->defaults().chinese);
    if (!waited) out.errors.push_back(waited.error());
    if (!waited && waited.error().code == Errc::bus) shell_->lose_bus();
    return out;
  }

  const drive::Profile* profile() {
    const auto& family = shell_->defaults().drive;
    const auto loaded = family.empty() ? Result<const drive::Profile*>(nullptr) : shell_->profile(family);
    return loaded ? *loaded : nullptr;
  }

  void tell(const Step& step, Outcome outcome) {
    if (settings_.json) return record(step, outcome);
    for (auto& error : outcome.errors) error = in_line(step, std::move(error));
    const bool silent = outcome.errors.empty() && outcome.notices.empty() && outcome.result.is_null();
    if (!silent) show(shell_->console(), outcome);
  }

  void record(const Step& step, const Outcome& outcome) {
    const bool ok = outcome.errors.empty();
    report::List notices;
    for (const auto& notice : outcome.notices) notices.emplace_back(notice.text());
    report::Record out{{"line", step.line},
                       {"text", step.text},
                       {"command", report::text_or_null(outcome.command)},
                       {"ok", ok},
                       {"result", outcome.result},
                       {"error", ok ? Value() : error_record(outcome)},
                       {"notices", std::move(notices)}};
    if (settings_.samples)
      shell_->console().json(report::to_json(out) + "\n");
    else
      records_.emplace_back(std::move(out));
  }

  Shell* shell_;
  const std::string* file_;
  Settings settings_;
  std::size_t count_;
  std::size_t done_ = 0;
  std::size_t failed_ = 0;
  const Step* last_step_ = nullptr;  ///< Of those that were taken.
  bool ended_ = false;               ///< By an error.
  bool has_let_go_ = false;
  Value last_;
  std::optional<Error> first_error_;
  report::List records_;
};

}  // namespace

int run_steps(Shell& shell, std::span<const Step> steps, const std::string& file) {
  const bool produced = shell.produces_sync();
  const bool stayed = shell.stay_open(true);
  shell.search_cabinet_once(true);
  BatchRun run(shell, steps, file);
  for (const auto& step : steps)
    if (!run.take(step)) break;
  run.hear_signal();
  // Nobody goes on with what the file began.
  if (run.has_failed()) run.let_go();
  int code = run.finish();
  if (!produced) shell.stop_sync();
  if (code == 0 && shell.cancelled()) {
    run.let_go();
    code = exit_code(Errc::interrupted);
  }
  shell.search_cabinet_once(false);
  shell.stay_open(stayed);
  return code;
}

Error at_line(const std::string& file, std::uint32_t line, Error error) {
  error.message = message("{}:{}: {}", as_it_is(file), line, error.message);
  if (!error.line) error.line = line;
  return error;
}

}  // namespace servoctl::cli
