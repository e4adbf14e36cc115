#include "cli/outcome.hpp"

#include <algorithm>
#include <iterator>

#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "report/catalogue.hpp"
#include "report/chinese_marks.hpp"
#include "report/chinese_value.hpp"
#include "report/json_writer.hpp"
#include "show/records.hpp"

namespace servoctl::cli {
namespace {

using report::List;
using report::Show;
using report::Table;
using report::Value;

/// A line for people, in the language of who reads. What is in Chinese already is not looked at again: words
/// that one types look like English.
std::string remark(std::string_view lead, Message what, const Outcome& outcome) {
  const bool chinese = outcome.settings.shows_chinese();
  if (chinese && !outcome.told) report::put_into_chinese(what);
  const auto text = what.text();
  if (!chinese || !has_chinese(text)) return std::string(lead) + printable(text) + "\n";
  return std::string(report::chinese_word(lead)) + printable(report::chinese_marks(text)) + "\n";
}

/// Errors as people read them: what happened, then what to do. The same advice for several errors is given
/// once.
std::string errors_text(const Outcome& outcome) {
  const auto& errors = outcome.errors;
  std::string out;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (i > 0 && errors[i].message == errors[i - 1].message) continue;
    out += remark("error: ", errors[i].message, outcome);
    const bool again = i + 1 < errors.size() && errors[i + 1].hint == errors[i].hint;
    if (!errors[i].hint.empty() && !again) out += remark("  hint: ", errors[i].hint, outcome);
  }
  return out;
}

/// Help and the manual page are in the language of who reads already.
Value shown(const Outcome& outcome) {
  const bool done =
      !outcome.settings.shows_chinese() || outcome.command == "help" || outcome.command == "man";
  return done ? outcome.result : report::chinese_value(outcome.result, &outcome.names);
}

/// The document of a line, in one piece: what shows it begins no text that it does not end. A result that is
/// written already may be of hundreds of megabytes, and is copied once.
std::string document(const Outcome& outcome) {
  constexpr std::size_t kAround = 4096;
  std::string out;
  if (const auto* written = std::get_if<report::Written>(&outcome.result.data()))
    out.reserve(written->json.size() + kAround);
  report::JsonWriter json(out);
  json.begin_record();
  json.member("servoctl", 1);
  json.text_or_null("command", outcome.command);
  json.member("ok", outcome.errors.empty());
  json.text_or_null("bus", outcome.uses_bus ? std::string_view(outcome.settings.bus) : std::string_view());
  if (!outcome.errors.empty()) json.member("error", error_record(outcome));
  json.member("result", outcome.result);
  json.key("notices");
  json.begin_list();
  for (const auto& notice : outcome.notices) json.value(notice.text());
  json.end_list();
  json.end_record();
  out += '\n';
  return out;
}

/// Whether both are one column: a key stands once in a record, whatever the text of either shows.
bool are_one(const Table::Column& a, const Table::Column& b) {
  return a.key == b.key && (a.show == Show::text) == (b.show == Show::text);
}

/// The columns of both, those of the first before those that only the second has.
void add_rows(Table& to, const Table& from) {
  std::vector<std::size_t> places;
  for (const auto& column : from.columns) {
    auto at = std::find_if(to.columns.begin(), to.columns.end(),
                           [&](const Table::Column& known) { return are_one(known, column); });
    if (at == to.columns.end()) {
      for (auto& row : to.rows) row.emplace_back();
      to.columns.push_back(column);
      at = to.columns.end() - 1;
    }
    if (at->show != column.show) at->show = Show::everywhere;
    places.push_back(static_cast<std::size_t>(at - to.columns.begin()));
  }
  for (const auto& row : from.rows) {
    List cells(to.columns.size());
    for (std::size_t i = 0; i < row.size(); ++i) cells[places[i]] = row[i];
    to.rows.push_back(std::move(cells));
  }
  to.documents.insert(to.documents.end(), from.documents.begin(), from.documents.end());
  to.json_only = to.json_only && from.json_only;
  to.below.insert(to.below.end(), from.below.begin(), from.below.end());
}

/// Tables become one, everything else a list.
Value joined(Value all, Value more) {
  if (all.is_null()) return more;
  if (more.is_null()) return all;
  auto* table = all.table();
  const auto* rows = more.table();
  if (table != nullptr && rows != nullptr) {
    add_rows(*table, *rows);
    return all;
  }
  List list;
  for (auto* one : {&all, &more}) {
    if (auto* inner = std::get_if<List>(&one->data()))
      std::move(inner->begin(), inner->end(), std::back_inserter(list));
    else
      list.push_back(std::move(*one));
  }
  return list;
}

}  // namespace

int Outcome::code() const { return errors.empty() ? 0 : exit_code(errors.front().code); }

Value error_record(const Outcome& outcome) {
  auto out = show::error_record(outcome.errors.front(), outcome.abort_words);
  for (auto& field : std::get<report::Record>(out.data()))
    if (field.key == "axis") field.value = report::text_or_null(outcome.axis);
  return out;
}

Outcome failed(Error error, Settings settings, std::string_view command) {
  Outcome out{.command = std::string(command), .settings = std::move(settings)};
  out.errors.push_back(std::move(error));
  return out;
}

std::string text_of(const Outcome& outcome, std::size_t width) {
  return report::to_text(shown(outcome), width);
}

int show(Console& console, const Outcome& outcome) {
  if (outcome.settings.json) {
    console.json(document(outcome));
  } else {
    console.out(text_of(outcome, console.width()));
    show_remarks(console, outcome);
  }
  return outcome.code();
}

void show_remarks(Console& console, const Outcome& outcome) {
  if (!outcome.settings.quiet || outcome.leaves_power)
    for (const auto& notice : outcome.notices) console.err(remark("notice: ", notice, outcome));
  console.err(errors_text(outcome));
}

void add_outcome(Outcome& all, Outcome part) {
  all.result = joined(std::move(all.result), std::move(part.result));
  if (all.errors.empty()) {
    all.abort_words = std::move(part.abort_words);
    all.axis = std::move(part.axis);
  }
  all.told = part.told;
  all.leaves_power = all.leaves_power || part.leaves_power;
  all.names.merge(part.names);
  std::move(part.errors.begin(), part.errors.end(), std::back_inserter(all.errors));
  std::move(part.notices.begin(), part.notices.end(), std::back_inserter(all.notices));
  if (("," + all.settings.bus + ",").find("," + part.settings.bus + ",") == std::string::npos)
    append(all.settings.bus, part.settings.bus, ",");
}

}  // namespace servoctl::cli
