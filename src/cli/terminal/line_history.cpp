#include "cli/terminal/line_history.hpp"

#include <algorithm>

#include "base/file.hpp"
#include "base/folded.hpp"
#include "base/found_file.hpp"
#include "base/regular_files.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::cli {
namespace {

/// The first line of a history of libedit, in which blanks and backslashes are `\040` and `\134`.
constexpr std::string_view kEditLineMark = "_HiStOrY_V2_";

bool is_octal(char c) { return c >= '0' && c <= '7'; }

std::string without_escapes(std::string_view line) {
  std::string out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto rest = line.substr(i);
    if (rest.size() > 3 && rest[0] == '\\' && is_octal(rest[1]) && is_octal(rest[2]) && is_octal(rest[3])) {
      out += static_cast<char>((rest[1] - '0') * 64 + (rest[2] - '0') * 8 + (rest[3] - '0'));
      i += 3;
    } else {
      out += line[i];
    }
  }
  return out;
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  const RegularFilesOnly regular;
  std::vector<std::string> out;
  const auto text = read_file(file, std::uintmax_t{16} << 20U);
  if (!text) return out;
  const auto lines = split(std::string_view(*text), '\n');
  const bool escaped = !lines.empty() && lines.front() == kEditLineMark;
  for (const auto line : lines) {
    if (line.empty() || line == kEditLineMark || !is_utf8(line)) continue;
    out.push_back(escaped ? without_escapes(line) : std::string(line));
  }
  return out;
}

void keep_newest(std::vector<std::string>& lines) {
  if (lines.size() > LineHistory::kMostLines)
    lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(LineHistory::kMostLines));
}

}  // namespace

void LineHistory::load(const std::filesystem::path& file) {
  for (auto& line : lines_of(file)) lines_.push_back(std::move(line));
  keep_newest(lines_);
}

Result<void> LineHistory::save(const std::filesystem::path& file) const {
  if (own_.empty()) return {};
  const RegularFilesOnly regular;
  auto lines = lines_of(file);
  lines.insert(lines.end(), own_.begin(), own_.end());
  keep_newest(lines);
  std::string text;
  for (const auto& line : lines) text += line + "\n";
  return write_own_file(file, text);
}

void LineHistory::add(std::string_view line) {
  if (!lines_.empty() && lines_.back() == line) return;
  lines_.emplace_back(line);
  own_.emplace_back(line);
  keep_newest(lines_);
}

bool LineHistory::holds(std::size_t i, std::string_view folded_text) const {
  return folded(lines_[i]).find(folded_text) != std::string::npos;
}

std::optional<std::size_t> LineHistory::find_older(std::string_view text, std::size_t before) const {
  const auto wanted = folded(text);
  for (auto i = std::min(before, lines_.size()); i-- > 0;)
    if (holds(i, wanted)) return i;
  return std::nullopt;
}

std::optional<std::size_t> LineHistory::find_newer(std::string_view text, std::size_t after) const {
  const auto wanted = folded(text);
  for (auto i = after + 1; i < lines_.size(); ++i)
    if (holds(i, wanted)) return i;
  return std::nullopt;
}

}  // namespace servoctl::cli
