#include "od/text_encoding.hpp"

#include <algorithm>

#include "base/utf8.hpp"
#include "od/code_page.hpp"
#include "od/text_bytes.hpp"

namespace servoctl::od {
namespace {

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";
constexpr std::size_t kSample = 16384;

std::size_t mark_of(std::string_view bytes, TextEncoding encoding) {
  if (encoding == TextEncoding::utf8) return bytes.starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0;
  const bool marked = bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
  return marked && (encoding == TextEncoding::utf16le || encoding == TextEncoding::utf16be) ? 2 : 0;
}

void locate_first_high(std::string_view bytes, DecodedText& out) {
  const auto first = std::min(next_high(bytes, 0), bytes.find('\0'));
  const auto before = bytes.substr(0, first < bytes.size() ? first : 0);
  out.line = static_cast<std::uint32_t>(std::count(before.begin(), before.end(), '\n') + 1);
  const auto line_start = before.rfind('\n');
  out.column = static_cast<std::uint32_t>(before.size() -
                                          (line_start == std::string_view::npos ? 0 : line_start + 1) + 1);
}

constexpr std::size_t unit_of(TextEncoding encoding) {
  return encoding == TextEncoding::utf16le || encoding == TextEncoding::utf16be ? 2 : 1;
}

/// The first character of UTF-16; none where a surrogate has no other half.
CodePoint first_of_utf16(std::string_view bytes, bool little) {
  constexpr std::size_t kUnit = 2;
  const auto unit = [&](std::size_t i) {
    const char32_t first = at(bytes, i);
    const char32_t second = at(bytes, i + 1);
    return little ? first | second << 8U : first << 8U | second;
  };
  if (bytes.size() < kUnit) return {};
  const auto first = unit(0);
  if (first < 0xD800 || first > 0xDFFF) return {first, kUnit};
  if (first > 0xDBFF || bytes.size() < 2 * kUnit) return {};
  const auto second = unit(kUnit);
  if (second < 0xDC00 || second > 0xDFFF) return {};
  return {0x10000 + ((first - 0xD800) << 10U) + (second - 0xDC00), 2 * kUnit};
}

CodePoint first_character(std::string_view bytes, TextEncoding encoding, const CodePage& page) {
  if (encoding == TextEncoding::utf8) return decode_utf8(bytes);
  if (unit_of(encoding) == 2) return first_of_utf16(bytes, encoding == TextEncoding::utf16le);
  return page.first(bytes);
}

/// All of it; a byte (UTF-16: a pair) that means nothing goes to `refused`, which says whether to go on. Text
/// that could be read goes to `converted`.
template <class Converted, class Refused>
void convert(std::string_view bytes, TextEncoding encoding, Converted converted, Refused refused) {
  const std::size_t unit = unit_of(encoding);
  const auto& page = CodePage::of(encoding);
  std::string chunk;
  while (!bytes.empty()) {
    const auto ascii = unit == 1 ? next_high(bytes, 0) : 0;
    converted(bytes.substr(0, ascii));
    bytes.remove_prefix(ascii);
    if (bytes.empty()) break;
    const auto character = first_character(bytes, encoding, page);
    if (character.value) {
      chunk.clear();
      append_utf8(*character.value, chunk);
      converted(chunk);
      bytes.remove_prefix(character.size);
    } else {
      const auto bad = bytes.substr(0, unit);
      if (!refused(bad)) return;
      bytes.remove_prefix(bad.size());
    }
  }
}

/// What cannot be read is written out, so that no byte is lost.
void convert(std::string_view bytes, DecodedText& out) {
  convert(
      bytes, out.encoding, [&](std::string_view text) { out.buffer += text; },
      [&](std::string_view bad) {
        constexpr std::string_view kDigits = "0123456789ABCDEF";
        for (std::size_t i = 0; i < bad.size(); ++i) {
          out.buffer += "\\x";
          out.buffer += kDigits[at(bad, i) >> 4U];
          out.buffer += kDigits[at(bad, i) & 0xFU];
        }
        out.odd_bytes += bad.size();
        return true;
      });
}

void drop_nuls(DecodedText& out) {
  const auto end = std::remove(out.buffer.begin(), out.buffer.end(), '\0');
  out.skipped_nuls = static_cast<std::size_t>(out.buffer.end() - end);
  out.buffer.erase(end, out.buffer.end());
}

}  // namespace

std::string_view name(TextEncoding encoding) {
  switch (encoding) {
    case TextEncoding::utf8: return "UTF-8";
    case TextEncoding::utf16le: return "UTF-16LE";
    case TextEncoding::utf16be: return "UTF-16BE";
    case TextEncoding::gbk: return "GBK";
    case TextEncoding::cp1252: return "CP1252";
    case TextEncoding::cp850: return "CP850";
    case TextEncoding::cp932: return "CP932";
    case TextEncoding::cp950: return "CP950";
    case TextEncoding::cp1251: return "CP1251";
  }
  return "UTF-8";
}

std::string_view title(TextEncoding encoding) {
  if (encoding == TextEncoding::cp932) return "Shift-JIS (CP932)";
  if (encoding == TextEncoding::cp950) return "Big5 (CP950)";
  return name(encoding);
}

bool means_something(std::string_view bytes, TextEncoding encoding) {
  bool whole = true;
  convert(
      bytes, encoding, [](std::string_view) {}, [&](std::string_view) { return whole = false; });
  return whole;
}

DecodedText to_utf8(std::string_view bytes) { return to_utf8(bytes, guess_encoding(bytes)); }

DecodedText to_utf8(std::string_view bytes, TextEncoding encoding) {
  DecodedText out;
  out.encoding = encoding;
  out.mark = mark_of(bytes, out.encoding);
  const auto content = bytes.substr(out.mark);
  if (out.encoding == TextEncoding::utf8) {
    const bool nuls = content.find('\0') != std::string_view::npos;
    if (!nuls && is_utf8_text(content)) return out;
    locate_first_high(content, out);
    out.own_bytes = false;
    if (nuls && is_utf8_text(content))
      out.buffer = content;
    else
      convert(content, out);
  } else {
    out.own_bytes = false;
    if (out.encoding != TextEncoding::utf16le && out.encoding != TextEncoding::utf16be)
      locate_first_high(content, out);
    convert(content, out);
  }
  drop_nuls(out);
  return out;
}

bool is_binary(std::string_view bytes) {
  const auto sample = bytes.substr(0, kSample);
  const auto odd = std::count_if(sample.begin(), sample.end(), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u < ' ' && u != '\0' && u != '\t' && u != '\n' && u != '\r' && u != '\f' && u != 0x1A;
  });
  return static_cast<std::size_t>(odd) * 20 > sample.size();
}

}  // namespace servoctl::od
