#include "cli/batch/variables.hpp"

#include <algorithm>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "cli/batch/batch.hpp"
#include "cli/restriction.hpp"

namespace servoctl::cli {
namespace {

constexpr std::uint64_t kLongestList = 100'000;
/// A variable that doubles in a loop must not take all memory.
constexpr std::size_t kLongestValue = 4'096;

struct Assignment {
  std::string name;
  std::string value;
};

Result<Assignment> parse_assignment(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos || !is_variable_name(text.substr(0, equals)))
    return fail(Errc::usage, message("'{}' is not NAME=VALUE", as_it_is(text)),
                "a name has letters, digits and _; put a value with blanks in quotes: NAME=\"two words\"");
  if (text.size() - equals > kLongestValue)
    return fail(Errc::usage, message("the value of {} is too long", as_it_is(text.substr(0, equals))));
  return Assignment{std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

/// `5` or `5-8`.
struct Range {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

std::optional<Range> parse_range(std::string_view text) {
  const auto dash = std::min(text.find('-'), text.size());
  const auto first = parse_digits(text.substr(0, dash), 10);
  const auto last = dash == text.size() ? first : parse_digits(text.substr(dash + 1), 10);
  if (!first || !last) return std::nullopt;
  return Range{*first, *last};
}

/// The ranges of `1,3,5-8`; empty when the word is no list of numbers.
std::vector<Range> parse_ranges(std::string_view word) {
  std::vector<Range> out;
  for (const auto part : split(word, ',')) {
    const auto range = parse_range(part);
    if (!range) return {};
    out.push_back(*range);
  }
  return out;
}

Result<void> add_word(std::vector<LoopItem>& out, const std::string& word) {
  const auto ranges = parse_ranges(word);
  // A single number keeps its form.
  if (ranges.empty() || word.find_first_of(",-") == std::string::npos) {
    out.push_back({word});
    return {};
  }
  for (const auto& range : ranges) {
    if (range.last < range.first)
      return fail(Errc::usage, message("'{}' runs backwards", as_it_is(word)), "write 5-8, not 8-5");
    if (range.last - range.first >= kLongestList || out.size() >= kLongestList)
      return fail(Errc::usage, message("'{}' is too long a list", as_it_is(word)));
    for (auto i = range.first; i <= range.last; ++i) out.push_back({std::to_string(i)});
  }
  return {};
}

Result<std::vector<LoopItem>> rows(const std::string& file, const std::filesystem::path& folder) {
  const auto text = read_file(folder / file);
  if (!text) return fail(text.error());
  const auto table = parse_csv(*text, file);
  if (!table) return fail(table.error());
  if (table->rows.empty())
    return fail(Errc::file, file + " has no line below its heading",
                "one line per pass of the loop is needed");
  std::vector<LoopItem> out;
  for (const auto& row : table->rows) {
    LoopItem item{row.cells.front(), formatted("{}:{}", file, row.line)};
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      item.cells.emplace_back(trim(table->columns[i]), trim(row.cells[i]));
    out.push_back(std::move(item));
  }
  return out;
}

bool names_csv(std::string_view word) { return word.size() > 4 && lower(word).ends_with(".csv"); }

}  // namespace

Result<void> Variables::fix(std::string_view assignment) {
  auto read = parse_assignment(assignment);
  if (!read) return fail(read.error());
  fixed_[read->name] = read->value;
  values_[read->name] = std::move(read->value);
  return {};
}

Result<void> Variables::set(std::string_view assignment) {
  auto read = parse_assignment(assignment);
  if (!read) return fail(read.error());
  if (!fixed_.contains(read->name)) values_[read->name] = std::move(read->value);
  return {};
}

void Variables::forget_row(const std::string& name) {
  std::erase_if(values_, [&](const auto& entry) { return entry.first.starts_with(name + "."); });
}

Result<std::string> Variables::value(std::string_view name) const {
  if (const auto found = values_.find(name); found != values_.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& entry : values_) known.push_back(entry.first);
  Message hint = did_you_mean(name, known);
  if (hint.empty()) hint = message("`set {0}=VALUE`, or --var {0}=VALUE on the command line", as_it_is(name));
  return fail(Errc::usage, message("unknown variable ${{{}}}", as_it_is(name)), std::move(hint));
}

Result<std::vector<LoopItem>> loop_items(std::span<const std::string> words,
                                         const std::filesystem::path& folder) {
  if (words.size() == 1 && names_csv(words.front())) {
    if (const auto* restriction = Restriction::current())
      if (const auto allowed = restriction->check_file(folder / words.front()); !allowed)
        return fail(allowed.error());
    return rows(words.front(), folder);
  }
  std::vector<LoopItem> out;
  for (const auto& word : words) {
    if (names_csv(word)) return fail(Errc::usage, "a CSV file must stand alone in its list");
    if (const auto added = add_word(out, word); !added) return fail(added.error());
  }
  if (out.empty()) return fail(Errc::usage, "the list of the loop is empty", "for NODE in 1-8");
  return out;
}

}  // namespace servoctl::cli
