#include "od/ini.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace servoctl::od {
namespace {

/// Takes one line off the text; LF, CRLF and a lone CR end it.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text), has_cr_(text.find('\r') != std::string_view::npos) {}

  bool empty() const { return text_.empty(); }

  std::string_view take() {
    const auto end = has_cr_ ? text_.find_first_of("\r\n") : text_.find('\n');
    const auto line = text_.substr(0, end);
    if (end == std::string_view::npos) {
      text_ = {};
      return line;
    }
    const bool crlf = text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n';
    text_.remove_prefix(end + (crlf ? 2 : 1));
    return line;
  }

 private:
  std::string_view text_;
  bool has_cr_;
};

IniSection section_of(std::string_view line, std::uint32_t number) {
  const auto close = line.find(']');
  const bool closed = close != std::string_view::npos;
  return {trim(line.substr(1, closed ? close - 1 : close)), number, closed, {}};
}

IniKey key_of(std::string_view whole, std::string_view line, std::size_t equals, std::uint32_t number) {
  const auto value = trim(line.substr(equals + 1));
  const auto* start = value.empty() ? line.data() + equals + 1 : value.data();
  const auto column = static_cast<std::uint32_t>(start - whole.data() + 1);
  return {trim(line.substr(0, equals)), value, number, column};
}

bool is_only_control(std::string_view line) {
  return std::all_of(line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; });
}

}  // namespace

const IniKey* IniSection::find(std::string_view key) const {
  const auto first_letter = [](std::string_view text) { return text.empty() ? 0 : text.front() | 0x20; };
  for (auto it = keys.rbegin(); it != keys.rend(); ++it)
    if (it->key.size() == key.size() && first_letter(it->key) == first_letter(key) &&
        equals_nocase(it->key, key))
      return &*it;
  return nullptr;
}

IniText parse_ini(std::string_view text) {
  IniText out;
  std::vector<std::size_t> first_keys;
  out.keys.reserve(static_cast<std::size_t>(std::count(text.begin(), text.end(), '=')));
  Lines lines(text);
  for (std::uint32_t number = 1; !lines.empty(); ++number) {
    const auto whole = lines.take();
    const auto line = trim(whole);
    if (line.empty() || line.front() == ';') continue;
    if (line.front() == '[') {
      out.sections.push_back(section_of(line, number));
      first_keys.push_back(out.keys.size());
      continue;
    }
    const auto equals = line.find('=');
    if (equals != std::string_view::npos && equals > 0 && !out.sections.empty() && line.front() != '#')
      out.keys.push_back(key_of(whole, line, equals, number));
    else if (!is_only_control(line))
      out.strays.push_back({number, line});
  }
  first_keys.push_back(out.keys.size());
  const std::span<const IniKey> keys(out.keys);
  for (std::size_t i = 0; i < out.sections.size(); ++i)
    out.sections[i].keys = keys.subspan(first_keys[i], first_keys[i + 1] - first_keys[i]);
  return out;
}

}  // namespace servoctl::od
