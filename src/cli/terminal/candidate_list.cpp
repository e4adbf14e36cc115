#include "cli/terminal/candidate_list.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"

namespace servoctl::cli {
namespace {

/// Between two columns.
constexpr std::size_t kColumnGap = 2;

std::size_t widest(std::span<const Candidate> candidates) {
  std::size_t out = 0;
  for (const auto& one : candidates) out = std::max(out, display_width(one.word));
  return out;
}

/// A number of an object or a parameter: without its name nobody knows it.
bool says_little(std::string_view word) { return word.find_first_of("0123456789") != std::string_view::npos; }

std::string more_row(std::size_t count, std::size_t columns) {
  return clip(formatted("... {} more: type another letter", count), columns - 1);
}

std::vector<std::string> rows_with_hints(std::span<const Candidate> candidates, std::size_t columns) {
  const auto width = std::min(widest(candidates), columns / 2);
  std::vector<std::string> out;
  for (const auto& one : candidates)
    out.push_back(clip(one.hint.empty() ? printable(one.word)
                                        : pad_right(clip(printable(one.word), width), width + kColumnGap) +
                                              printable(one.hint),
                       columns - 1));
  return out;
}

}  // namespace

std::string common_beginning(std::span<const Candidate> candidates) {
  if (candidates.empty()) return {};
  std::string out = candidates.front().word;
  for (const auto& one : candidates)
    while (!starts_with_nocase(one.word, out)) out.pop_back();
  // Not in the middle of a character.
  const auto& first = candidates.front().word;
  while (!out.empty() && out.size() < first.size() &&
         (static_cast<unsigned char>(first[out.size()]) & 0xC0U) == 0x80)
    out.pop_back();
  return out;
}

void prefer_exact(std::vector<Candidate>& candidates, std::string_view typed) {
  const auto is_exact = [typed](const Candidate& one) { return one.word.starts_with(typed); };
  const std::vector<Candidate> all = candidates;
  std::erase_if(candidates, [&](const Candidate& one) {
    return !is_exact(one) && std::any_of(all.begin(), all.end(), [&](const Candidate& other) {
      return is_exact(other) && equals_nocase(other.word, one.word);
    });
  });
}

std::string begun_further(std::span<const Candidate> candidates, std::string_view typed) {
  auto common = common_beginning(candidates);
  if (common.size() <= typed.size()) return {};
  const auto begun = std::string_view(common).substr(0, typed.size());
  const bool alike = std::all_of(candidates.begin(), candidates.end(),
                                 [&](const Candidate& one) { return one.word.starts_with(begun); });
  if (alike || !equals_nocase(begun, typed)) return common;
  return std::string(typed) + common.substr(typed.size());
}

std::vector<std::string> candidate_rows(std::span<const Candidate> candidates, std::size_t columns,
                                        std::size_t rows) {
  if (candidates.empty() || rows == 0 || columns < 4) return {};
  const bool hints =
      std::any_of(candidates.begin(), candidates.end(), [](const auto& one) { return !one.hint.empty(); });
  if (hints && candidates.size() <= rows) return rows_with_hints(candidates, columns);
  if (hints && rows > 1 && says_little(candidates.front().word)) {
    auto out = rows_with_hints(candidates.first(rows - 1), columns);
    out.push_back(more_row(candidates.size() - (rows - 1), columns));
    return out;
  }
  const auto width = std::min(widest(candidates) + kColumnGap, columns - 1);
  const auto across = std::max<std::size_t>(1, (columns - 1) / width);
  const bool all = candidates.size() <= across * rows;
  const auto shown = all ? candidates.size() : across * (rows - 1);
  const auto down = (shown + across - 1) / across;
  std::vector<std::string> out(down);
  for (std::size_t i = 0; i < shown; ++i)
    out[i % down] += pad_right(clip(printable(candidates[i].word), width), width);
  if (!all) out.push_back(more_row(candidates.size() - shown, columns));
  return out;
}

}  // namespace servoctl::cli
