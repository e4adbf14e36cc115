#include "od/text_encoding.hpp"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>

#include "base/utf8.hpp"

namespace servoctl::od {
namespace {

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";
constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
constexpr std::size_t kSample = 16384;

unsigned char at(std::string_view bytes, std::size_t i) { return static_cast<unsigned char>(bytes[i]); }

bool is_ascii_letter(unsigned char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// The first byte at or after `from` above 0x7F; the length when there is none.
std::size_t next_high(std::string_view bytes, std::size_t from) {
  std::uint64_t eight{};
  for (; from + sizeof eight <= bytes.size(); from += sizeof eight) {
    std::memcpy(&eight, bytes.data() + from, sizeof eight);
    if ((eight & 0x8080'8080'8080'8080U) != 0) break;
  }
  while (from < bytes.size() && at(bytes, from) < 0x80) ++from;
  return from;
}

/// A Chinese character or punctuation mark of GB 2312. Two equal bytes are rather a ruled line of CP437.
bool is_chinese_pair(unsigned char lead, unsigned char trail) {
  return trail >= 0xA1 && trail <= 0xFE && lead != trail &&
         ((lead >= 0xB0 && lead <= 0xF7) || lead == 0xA1 || lead == 0xA3);
}

bool looks_chinese(std::string_view bytes) {
  std::size_t all = 0;
  std::size_t chinese = 0;
  for (auto i = next_high(bytes, 0); i < bytes.size(); i = next_high(bytes, i)) {
    const auto start = i;
    std::size_t pairs = 0;
    while (i < bytes.size() && at(bytes, i) >= 0x80) {
      const bool pair = i + 1 < bytes.size() && is_chinese_pair(at(bytes, i), at(bytes, i + 1));
      pairs += pair ? 1 : 0;
      i += pair ? 2 : 1;
    }
    all += i - start;
    if (pairs >= 2) chinese += 2 * pairs;
  }
  return 2 * chinese > all;
}

bool looks_like_dos(std::string_view bytes) {
  std::size_t low = 0;
  std::size_t high = 0;
  for (auto i = next_high(bytes, 0); i < bytes.size(); i = next_high(bytes, i + 1)) {
    const auto c = at(bytes, i);
    const auto after = bytes.substr(i + 1);
    const bool behind_letter = i > 0 && is_ascii_letter(at(bytes, i - 1));
    const bool before_letter = !after.empty() && is_ascii_letter(at(after, 0));
    const bool quote_or_dash = c >= 0x91 && c <= 0x97 && c != 0x94;
    const bool degree = c == 0xF8 && !behind_letter && (!before_letter || after.front() == 'C');
    if (degree || (c < 0xA0 && (behind_letter || before_letter) && !quote_or_dash))
      ++low;
    else if (c >= 0xA0)
      ++high;
  }
  return low > high;
}

/// UTF-16 of mostly ASCII has its NULs all on one side of the pairs.
std::optional<TextEncoding> utf16_of(std::string_view sample) {
  std::size_t first = 0;
  std::size_t second = 0;
  for (std::size_t i = 0; i < sample.size(); ++i)
    if (sample[i] == '\0') ++(i % 2 == 0 ? first : second);
  const auto is_side = [&](std::size_t nuls, std::size_t others) {
    return 5 * nuls > sample.size() && 20 * others < nuls;
  };
  if (is_side(second, first)) return TextEncoding::utf16le;
  if (is_side(first, second)) return TextEncoding::utf16be;
  return std::nullopt;
}

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

/// iconv over all of it; a byte (UTF-16: a pair) it refuses becomes U+FFFD.
void convert(std::string_view bytes, DecodedText& out) {
  const iconv_t converter = iconv_open("UTF-8", name(out.encoding).data());
  const std::size_t unit =
      out.encoding == TextEncoding::utf16le || out.encoding == TextEncoding::utf16be ? 2 : 1;
  auto* from = const_cast<char*>(bytes.data());  // NOLINT: iconv does not write through it.
  std::size_t left = bytes.size();
  std::array<char, kSample> chunk{};
  while (left > 0) {
    auto* to = chunk.data();
    std::size_t room = chunk.size();
    const auto done = iconv(converter, &from, &left, &to, &room);
    out.buffer.append(chunk.data(), chunk.size() - room);
    if (done != static_cast<std::size_t>(-1) || errno == E2BIG) continue;
    const auto bad = std::min(unit, left);
    from += bad;
    left -= bad;
    ++out.replaced_bytes;
    out.buffer += kReplacement;
  }
  iconv_close(converter);
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
  }
  return "UTF-8";
}

TextEncoding guess_encoding(std::string_view bytes) {
  if (bytes.starts_with(kUtf8Mark)) return TextEncoding::utf8;
  if (bytes.starts_with("\xFF\xFE")) return TextEncoding::utf16le;
  if (bytes.starts_with("\xFE\xFF")) return TextEncoding::utf16be;
  const auto sample = bytes.substr(0, kSample);
  if (sample.find('\0') != std::string_view::npos)
    if (const auto utf16 = utf16_of(sample)) return *utf16;
  if (is_utf8(bytes)) return TextEncoding::utf8;
  if (looks_chinese(bytes)) return TextEncoding::gbk;
  return looks_like_dos(bytes) ? TextEncoding::cp850 : TextEncoding::cp1252;
}

DecodedText to_utf8(std::string_view bytes) {
  DecodedText out;
  out.encoding = guess_encoding(bytes);
  out.mark = mark_of(bytes, out.encoding);
  const auto content = bytes.substr(out.mark);
  if (out.encoding == TextEncoding::utf8) {
    const bool nuls = content.find('\0') != std::string_view::npos;
    if (!nuls && is_utf8(content)) return out;
    locate_first_high(content, out);
    out.own_bytes = false;
    if (nuls && is_utf8(content))
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
