#include "od/ini.hpp"

#include "base/text.hpp"

namespace servoctl::od {
namespace {

/// Takes one line off the text; LF, CRLF and a lone CR end it.
std::string_view take_line(std::string_view& text) {
  const auto end = text.find_first_of("\r\n");
  const auto line = text.substr(0, end);
  if (end == std::string_view::npos) {
    text = {};
    return line;
  }
  const bool crlf = text[end] == '\r' && end + 1 < text.size() && text[end + 1] == '\n';
  text.remove_prefix(end + (crlf ? 2 : 1));
  return line;
}

void add_section(IniText& out, std::string_view line, std::uint32_t number) {
  const auto close = line.find(']');
  const auto name = trim(line.substr(1, close == std::string_view::npos ? close : close - 1));
  out.by_name.emplace(lower(name), out.sections.size());
  out.sections.push_back({name, number, {}});
}

}  // namespace

const IniKey* IniSection::find(std::string_view key) const {
  for (auto it = keys.rbegin(); it != keys.rend(); ++it)
    if (equals_nocase(it->key, key)) return &*it;
  return nullptr;
}

const IniSection* IniText::find(std::string_view name) const {
  const auto found = by_name.find(lower(name));
  return found == by_name.end() ? nullptr : &sections[found->second];
}

IniText parse_ini(std::string_view text) {
  IniText out;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (std::uint32_t number = 1; !text.empty(); ++number) {
    const auto whole = take_line(text);
    const auto line = trim(whole);
    if (line.empty() || line.front() == ';') continue;
    if (line.front() == '[') {
      add_section(out, line, number);
      continue;
    }
    const auto equals = line.find('=');
    if (equals == std::string_view::npos || out.sections.empty()) {
      out.strays.push_back({number, line});
      continue;
    }
    const auto value = trim(line.substr(equals + 1));
    const auto column = static_cast<std::uint32_t>((value.empty() ? line.data() + equals + 1 : value.data()) -
                                                   whole.data() + 1);
    out.sections.back().keys.push_back({trim(line.substr(0, equals)), value, number, column});
  }
  return out;
}

}  // namespace servoctl::od
