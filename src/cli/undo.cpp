// `undo`: what is held against the drive before a value is put back.
#include <algorithm>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "can/socketcan.hpp"
#include "cli/last_write.hpp"
#include "cli/shell.hpp"
#include "session/identify.hpp"
#include "session/open_bus.hpp"
#include "show/identity.hpp"

namespace servoctl::cli {
namespace {

using WrittenValue = LastWrite::Value;
using WrittenLine = LastWrite::Line;

/// `opening`: the present one of the bus. While it was not open restarts were not heard.
Result<void> check_value(session::Session& session, std::uint64_t opening, const WrittenValue& value) {
  const auto refused = [&](const Message& why) {
    return fail(
        drive_error(Errc::refused, value.node, why, "nothing was changed; `param set` writes it by hand"));
  };
  if (opening == value.opening && session.watch().boots(value.node) != value.boots)
    return refused("has restarted since it was written to");
  const auto identity = session::read_identity(session, value.node);
  if (!identity) return fail(identity.error());
  if (const auto change = show::change_of(value.identity, *identity); !change.empty())
    return refused(message("is another drive than the one that was written to: {}", change));
  const auto now = session.upload(value.node, value.object);
  if (!now) return fail(now.error());
  // Where an undo was cut off behind its write it holds that already.
  if (*now != value.after && *now != value.before)
    return refused(message("no longer holds in {} ({}) what was written: somebody has changed it since",
                           as_it_is(value.name), to_string(value.object)));
  return {};
}

/// A name without a colon that is no interface may be that of a bus of the cabinet.
std::string url_in_use(Shell& shell) {
  const auto& bus = shell.defaults().bus;
  const bool may_be_name = bus.find(':') == std::string::npos && !can::is_interface(bus);
  const auto cabinet =
      may_be_name ? shell.cabinet(shell.defaults()) : Result<const cabinet::Cabinet*>(nullptr);
  const auto* known = cabinet && *cabinet != nullptr ? (*cabinet)->bus(bus) : nullptr;
  return session::canonical_url(known != nullptr ? known->url : bus);
}

/// The session, where the prompt still is where the line was, and all drives hold what it wrote.
Result<void> check_line(Shell& shell, const WrittenLine& line) {
  if (!line.why_not.empty())
    return fail(Errc::refused, "the last write is not put back: " + line.why_not,
                "`param set` or `write` writes a value by hand");
  auto settings = shell.defaults();
  if (!line.by_axis && url_in_use(shell) != session::canonical_url(line.bus))
    return fail(Errc::refused,
                message("the last write was on {}, and the prompt is not there any more", as_it_is(line.bus)),
                message("`bus {}`, and then `undo`", as_it_is(line.bus)));
  if (settings.nodes != line.place)
    return fail(Errc::refused,
                message("the last write was made with {} in use, and now {} is",
                        line.place.empty() ? Message("no node") : Message(as_it_is(line.place)),
                        settings.nodes.empty() ? Message("none") : Message(as_it_is(settings.nodes))),
                line.place.empty() ? "`param set` writes it by hand"
                                   : message("`use {}`, and then `undo`", as_it_is(line.place)));
  settings.bus = line.bus;
  settings.of_cabinet = line.of_cabinet;
  settings.names = line.names;
  const auto session = shell.open(settings);
  if (!session) return fail(session.error());
  for (const auto& value : line.values)
    if (const auto same = check_value(**session, shell.opening(**session), value); !same) return same;
  return {};
}

std::string undo_question(const WrittenLine& line) {
  std::string out;
  for (const auto& value : line.values) {
    if (!out.empty()) out += "; ";
    const auto after = value.after_shown.empty() ? "what was written" : value.after_shown;
    out +=
        value.target == std::to_string(value.node)
            ? formatted("{} on node {}: {} in place of {}", value.shown, value.node, value.before_shown,
                        after)
            : formatted("{} on {}: {} in place of {}", value.shown, value.target, value.before_shown, after);
  }
  const bool blind = std::any_of(line.values.begin(), line.values.end(),
                                 [](const WrittenValue& value) { return value.identity.by_registers; });
  return std::string(blind ? "Over Modbus nothing tells whether it is the same drive. " : "") +
         (line.turned ? "This takes back the last `undo`. " : "") +
         (line.keep ? formatted("Put back, and keep at power-off, {}?", out)
                    : formatted("Put back {}?", out));
}

Result<void> confirm_undo(Shell& shell, const WrittenLine& line, bool yes) {
  if (yes || shell.defaults().yes) return {};
  const auto shown = printable(undo_question(line));
  if (!shell.console().can_ask())
    return fail(Errc::refused, "confirmation needed: " + shown, "`undo --yes` confirms");
  if (shell.console().ask(shell.console().in_language(shown))) return {};
  return fail(Errc::refused, "not confirmed; nothing was changed");
}

/// A line that puts one value back.
std::vector<std::string> words_of(const WrittenLine& line, const WrittenValue& value, bool yes) {
  std::vector<std::string> out;
  for (const auto part : split(std::string_view(line.command), ' ')) out.emplace_back(part);
  const auto add = [&out](std::initializer_list<std::string> words) { out.insert(out.end(), words); };
  // Of an axis too by its number: what the cabinet file calls so may be another drive now.
  add({"-n", std::to_string(value.node), "-b", line.bus});
  if (!line.drive.empty()) add({"-d", line.drive});
  if (!value.type.empty()) add({"--type", value.type});
  if (line.keep) add({"--keep"});
  if (line.unlock) add({"--unlock"});
  if (yes) add({"--yes"});
  add({"--", value.name, value.before_text});
  return out;
}

/// What the lines that put back have of the line they put back, though their words name a bus and numbers:
/// the cabinet's other buses stay open, and answers speak of axes.
class AsOfCabinet {
 public:
  AsOfCabinet(Shell& shell, const WrittenLine& line)
      : defaults_(&shell.defaults()), of_cabinet_(defaults_->of_cabinet), names_(defaults_->names) {
    defaults_->of_cabinet = line.of_cabinet;
    defaults_->names = line.names;
  }
  AsOfCabinet(const AsOfCabinet&) = delete;
  AsOfCabinet& operator=(const AsOfCabinet&) = delete;
  ~AsOfCabinet() {
    defaults_->of_cabinet = of_cabinet_;
    defaults_->names = std::move(names_);
  }

 private:
  Settings* defaults_;
  bool of_cabinet_;
  show::AxisNames names_;
};

/// From the last to the first; what is left when one fails can be put back later.
int put_back(Shell& shell, const WrittenLine& line, bool yes) {
  const AsOfCabinet as(shell, line);
  auto left = line;
  int code = 0;
  while (!left.values.empty() && code == 0) {
    code = shell.run(words_of(left, left.values.back(), yes));
    if (code == 0) left.values.pop_back();
  }
  if (code == 0) {
    shell.last_write().turn_round(line);
    return code;
  }
  if (left.values.size() < line.values.size())
    shell.console().note(formatted("notice: {} of {} values are put back; `undo` goes on with the others\n",
                                   line.values.size() - left.values.size(), line.values.size()));
  shell.last_write().keep(std::move(left));
  return code;
}

}  // namespace

int undo(Shell& shell, bool yes) {
  const auto* last = shell.last_write().line();
  if (last == nullptr)
    return shell.report_error(make_error(Errc::usage, "there is nothing to put back",
                                         "`undo` puts back what a `param set` or `write` of this prompt "
                                         "replaced"),
                              shell.defaults().json, "undo");
  const auto line = *last;
  auto right = check_line(shell, line);
  if (right) right = confirm_undo(shell, line, yes);
  // Somebody may have thought about the question for a while.
  if (right) right = check_line(shell, line);
  if (!right) return shell.report_error(right.error(), shell.defaults().json, "undo");
  return put_back(shell, line, yes);
}

}  // namespace servoctl::cli
