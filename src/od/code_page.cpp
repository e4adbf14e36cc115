#include "od/code_page.hpp"

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "base/embedded.hpp"
#include "base/number.hpp"
#include "od/text_bytes.hpp"

SERVOCTL_EMBED(servoctl_code_pages, "od/code_pages.txt")

namespace servoctl::od {
namespace {

constexpr std::size_t kAscii = 0x80;
constexpr std::size_t kRow = 0x100;

std::string_view lines_of_pages() { return {servoctl_code_pages_begin, servoctl_code_pages_end}; }

}  // namespace

/// A line is `GBK 81 40 丂丄…`: the encoding, the first byte of two or `-`, the last byte of the first
/// character, the characters.
CodePage::CodePage(TextEncoding encoding) : single_(kRow), doubles_((kRow - kAscii) * kRow) {
  for (std::size_t c = 0; c < kAscii; ++c) single_[c] = static_cast<char16_t>(c);
  const auto wanted = std::string(name(encoding)) + ' ';
  for (auto rest = lines_of_pages(); !rest.empty(); rest.remove_prefix(rest.find('\n') + 1)) {
    if (!rest.starts_with(wanted)) continue;
    auto line = rest.substr(wanted.size(), rest.find('\n') - wanted.size());
    const auto next_byte = [&line] {
      const auto word = line.substr(0, line.find(' '));
      line.remove_prefix(word.size() + 1);
      return parse_digits(word, 16);
    };
    const auto lead = next_byte();
    auto last = next_byte().value_or(0);
    for (; !line.empty(); ++last) {
      const auto character = decode_utf8(line);
      (lead ? doubles_[(*lead - kAscii) * kRow + last] : single_[last]) =
          static_cast<char16_t>(character.value.value_or(0));
      line.remove_prefix(character.size);
    }
  }
}

const CodePage& CodePage::of(TextEncoding encoding) {
  static std::map<TextEncoding, CodePage> made;
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  if (const auto found = made.find(encoding); found != made.end()) return found->second;
  return made.emplace(encoding, CodePage(encoding)).first->second;
}

CodePoint CodePage::first(std::string_view bytes) const {
  const std::size_t lead = at(bytes, 0);
  if (single_[lead] != 0 || lead == 0) return {single_[lead], 1};
  if (bytes.size() < 2) return {};
  const auto value = doubles_[(lead - kAscii) * kRow + at(bytes, 1)];
  return value == 0 ? CodePoint{} : CodePoint{value, 2};
}

}  // namespace servoctl::od
