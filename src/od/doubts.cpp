#include "od/doubts.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::od {
namespace {

const Mark* find(const std::vector<Mark>& marks, std::string_view field) {
  const auto found =
      std::find_if(marks.begin(), marks.end(), [&](const Mark& m) { return m.field == field; });
  return found == marks.end() ? nullptr : &*found;
}

std::optional<Mark> parse_mark(std::string_view text) {
  const auto words = split(text, ' ');
  if (words.empty()) return std::nullopt;
  Mark out;
  out.field = std::string(words.front());
  if (out.field.empty() || parse_digits(out.field, 10)) return std::nullopt;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto line = parse_digits(words[i], 10);
    if (!line || *line == 0 || *line > 0xFFFF'FFFFU) return std::nullopt;
    out.lines.push_back(static_cast<std::uint32_t>(*line));
  }
  return out;
}

}  // namespace

std::optional<std::vector<Mark>> parse_marks(std::string_view text) {
  std::vector<Mark> out;
  if (text.empty()) return out;
  for (const auto part : split(text, ';')) {
    auto mark = parse_mark(part);
    if (!mark || find(out, mark->field) != nullptr) return std::nullopt;
    out.push_back(std::move(*mark));
  }
  return out;
}

std::string to_text(const std::vector<Mark>& marks) {
  std::string out;
  for (const auto& mark : marks) {
    append(out, mark.field);
    if (!mark.lines.empty())
      out += formatted(" ({} {})", mark.lines.size() == 1 ? "line" : "lines", fmt::join(mark.lines, ", "));
  }
  return out;
}

bool Doubts::about(std::string_view field) const {
  return find(assumed, field) != nullptr || find(contradicted, field) != nullptr;
}

std::string_view Doubts::sign() const {
  if (assumed.empty()) return contradicted.empty() ? "" : "!";
  return contradicted.empty() ? "?" : "?!";
}

}  // namespace servoctl::od
