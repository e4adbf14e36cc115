#include "report/po.hpp"

#include <cstdint>
#include <optional>
#include <unordered_set>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::report {
namespace {

/// The character that an escape stands for.
std::optional<char> escaped_char(char c) {
  switch (c) {
    case 'n': return '\n';
    case 't': return '\t';
    case 'r': return '\r';
    case '"': return '"';
    case '\\': return '\\';
    default: return std::nullopt;
  }
}

class PoReader {
 public:
  PoReader(std::string_view text, std::string_view file) : text_(text), file_(file) {}

  Result<std::vector<PoEntry>> read() {
    for (const auto line : split(text_, '\n')) {
      ++line_;
      if (const auto right = take(trim(line)); !right) return fail(right.error());
    }
    if (const auto right = finish(); !right) return fail(right.error());
    return std::move(out_);
  }

 private:
  enum class Part : std::uint8_t { none, id, text };

  tl::unexpected<Error> wrong(const Message& why) const {
    return fail(file_error(file_, static_cast<std::uint32_t>(line_), why));
  }

  Result<void> take(std::string_view line) {
    if (line.empty()) return {};
    if (line.starts_with("#.")) {
      if (part_ == Part::text)
        if (auto right = finish(); !right) return right;
      entry_.remarks.emplace_back(trim(line.substr(2)));
      return {};
    }
    if (line.front() == '#') return {};
    if (line.starts_with("msgid ")) {
      if (auto right = finish(); !right) return right;
      entry_.line = line_;
      part_ = Part::id;
      return add(line.substr(6), entry_.id);
    }
    if (line.starts_with("msgstr ")) {
      if (part_ != Part::id) return wrong("msgstr without msgid");
      part_ = Part::text;
      return add(line.substr(7), entry_.text);
    }
    if (line.front() != '"' || part_ == Part::none)
      return wrong("neither msgid, msgstr, a comment nor a string");
    return add(line, part_ == Part::id ? entry_.id : entry_.text);
  }

  Result<void> add(std::string_view quoted, std::string& into) const {
    quoted = trim(quoted);
    if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"')
      return wrong("a string ends with \"");
    const auto inner = quoted.substr(1, quoted.size() - 2);
    if (inner.find('"') == std::string_view::npos && inner.find('\\') == std::string_view::npos) {
      into += inner;
      return {};
    }
    for (std::size_t i = 0; i < inner.size(); ++i) {
      if (inner[i] == '"') return wrong("a quote within a string is written \\\"");
      if (inner[i] != '\\') {
        into += inner[i];
        continue;
      }
      const auto c = ++i < inner.size() ? escaped_char(inner[i]) : std::nullopt;
      if (!c) return wrong("unknown escape");
      into += *c;
    }
    return {};
  }

  Result<void> finish() {
    if (part_ == Part::none) return {};
    if (part_ == Part::id) return wrong("msgid without msgstr");
    part_ = Part::none;
    if (!entry_.id.empty()) {
      if (!known_.insert(entry_.id).second)
        return wrong(message("the msgid of line {} appears twice", entry_.line));
      out_.push_back(std::move(entry_));
    }
    entry_ = {};
    return {};
  }

  std::string_view text_;
  std::string_view file_;
  std::size_t line_ = 0;
  Part part_ = Part::none;
  PoEntry entry_;
  std::unordered_set<std::string> known_;
  std::vector<PoEntry> out_;
};

}  // namespace

Result<std::vector<PoEntry>> parse_po(std::string_view text, std::string_view file) {
  return PoReader(text, file).read();
}

}  // namespace servoctl::report
