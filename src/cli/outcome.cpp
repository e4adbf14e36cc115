#include "cli/outcome.hpp"

#include "base/printable.hpp"
#include "report/chinese_value.hpp"
#include "show/records.hpp"

namespace servoctl::cli {
namespace {

using report::Value;

/// Errors as people read them: what happened, then what to do. The same advice for several errors is given
/// once.
std::string errors_text(std::span<const Error> errors) {
  std::string out;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (i > 0 && errors[i].message == errors[i - 1].message) continue;
    out += "error: " + printable(errors[i].message) + "\n";
    const bool again = i + 1 < errors.size() && errors[i + 1].hint == errors[i].hint;
    if (!errors[i].hint.empty() && !again) out += "  hint: " + printable(errors[i].hint) + "\n";
  }
  return out;
}

/// Help is in the language of who reads already.
Value shown(const Outcome& outcome) {
  const bool english = !outcome.settings.shows_chinese() || outcome.command == "help";
  return english ? outcome.result : report::chinese_value(outcome.result);
}

report::Record envelope(const Outcome& outcome) {
  report::Record out{{"servoctl", 1},
                     {"command", report::text_or_null(outcome.command)},
                     {"ok", outcome.errors.empty()},
                     {"bus", outcome.uses_bus ? report::text_or_null(outcome.settings.bus) : Value()}};
  if (!outcome.errors.empty())
    out.push_back({"error", show::error_record(outcome.errors.front(), outcome.abort_words)});
  out.push_back({"result", outcome.result});
  report::List notices;
  for (const auto& notice : outcome.notices) notices.emplace_back(notice);
  out.push_back({"notices", std::move(notices)});
  return out;
}

}  // namespace

int Outcome::code() const { return errors.empty() ? 0 : exit_code(errors.front().code); }

Outcome failed(Error error, Settings settings, std::string_view command) {
  Outcome out{.command = std::string(command), .settings = std::move(settings)};
  out.errors.push_back(std::move(error));
  return out;
}

int show(Console& console, const Outcome& outcome) {
  if (outcome.settings.json) {
    console.out(report::to_json(envelope(outcome)) + "\n");
  } else {
    console.out(report::to_text(shown(outcome), console.width()));
    show_remarks(console, outcome);
  }
  return outcome.code();
}

void show_remarks(Console& console, const Outcome& outcome) {
  if (!outcome.settings.quiet || outcome.leaves_power)
    for (const auto& notice : outcome.notices) console.err("notice: " + printable(notice) + "\n");
  console.err(errors_text(outcome.errors));
}

}  // namespace servoctl::cli
