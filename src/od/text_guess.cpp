#include <algorithm>
#include <array>
#include <optional>

#include "od/text_bytes.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::od {
namespace {

constexpr std::size_t kGuessedFrom = 16384;

bool is_ascii_letter(unsigned char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool is_within(unsigned char c, unsigned char low, unsigned char high) { return c >= low && c <= high; }

/// Whether two bytes are a character of an encoding, and one that texts are made of. Two equal bytes are
/// rather a ruled line of CP437.
using IsPair = bool (*)(unsigned char lead, unsigned char trail);

/// A Chinese character or punctuation mark of GB 2312.
bool is_gb2312(unsigned char lead, unsigned char trail) {
  return is_within(trail, 0xA1, 0xFE) && lead != trail &&
         (is_within(lead, 0xB0, 0xF7) || lead == 0xA1 || lead == 0xA3);
}

/// A frequent Chinese character of Big5, or a punctuation mark; the second byte may be ASCII.
bool is_big5(unsigned char lead, unsigned char trail) {
  return is_within(lead, 0xA1, 0xC6) && lead != trail &&
         (is_within(trail, 0x40, 0x7E) || is_within(trail, 0xA1, 0xFE));
}

/// Kana, a character of level 1 of JIS X 0208, a wide letter, digit or mark; the second byte may be ASCII.
bool is_shift_jis(unsigned char lead, unsigned char trail) {
  if (trail < 0x40 || trail == 0x7F || trail > 0xFC || lead == trail) return false;
  switch (lead) {
    case 0x81: return trail <= 0xAC;
    case 0x82: return is_within(trail, 0x4F, 0x9A) || is_within(trail, 0x9F, 0xF1);
    case 0x83: return trail <= 0x96;
    case 0x88: return trail >= 0x9F;
    case 0x98: return trail <= 0x72;
    default: return is_within(lead, 0x89, 0x97);
  }
}

/// Of the bytes in runs above 0x7F: those that are characters in rows of two or more, where more than half
/// are; else 0.
std::size_t bytes_of_text(std::string_view bytes, IsPair is_pair) {
  std::size_t all = 0;
  std::size_t fitting = 0;
  for (auto i = next_high(bytes, 0); i < bytes.size(); i = next_high(bytes, i)) {
    const auto start = i;
    std::size_t pairs = 0;
    while (i < bytes.size() && at(bytes, i) >= 0x80) {
      const bool pair = i + 1 < bytes.size() && is_pair(at(bytes, i), at(bytes, i + 1));
      pairs += pair ? 1 : 0;
      i += pair ? 2 : 1;
    }
    all += i - start;
    if (pairs >= 2) fitting += 2 * pairs;
  }
  return 2 * fitting > all ? fitting : 0;
}

/// Most bytes above 0x7F are letters of CP1251 in words of three or more, small ones behind capitals. Chinese
/// has its bytes in no such order.
bool looks_cyrillic(std::string_view bytes) {
  const auto is_small = [](unsigned char c) { return c >= 0xE0 || c == 0xB8; };
  const auto is_letter = [](unsigned char c) { return c >= 0xC0 || c == 0xA8 || c == 0xB8; };
  std::size_t all = 0;
  std::size_t in_words = 0;
  std::size_t small = 0;
  std::size_t disorders = 0;  // A capital behind a small letter.
  for (auto i = next_high(bytes, 0); i < bytes.size(); i = next_high(bytes, i)) {
    const auto start = i;
    while (i < bytes.size() && is_letter(at(bytes, i))) ++i;
    all += std::max<std::size_t>(i - start, 1);
    const bool beside_ascii = (start > 0 && is_ascii_letter(at(bytes, start - 1))) ||
                              (i < bytes.size() && is_ascii_letter(at(bytes, i)));
    for (auto k = start; k < i && i - start >= 3 && !beside_ascii; ++k) {
      ++in_words;
      if (is_small(at(bytes, k))) ++small;
      if (k > start && is_small(at(bytes, k - 1)) && !is_small(at(bytes, k))) ++disorders;
    }
    if (i == start) ++i;
  }
  constexpr std::size_t kCapitalsEnough = 12;
  const bool of_letters = 2 * small >= in_words || (small == 0 && in_words >= kCapitalsEnough);
  return 3 * in_words > 2 * all && of_letters && 20 * disorders <= in_words;
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

/// The one of the East Asian encodings in which more bytes are characters than in the others.
std::optional<TextEncoding> east_asian(std::string_view bytes) {
  struct Candidate {
    TextEncoding encoding;
    std::size_t fitting;
  };
  const std::array candidates{Candidate{TextEncoding::gbk, bytes_of_text(bytes, is_gb2312)},
                              Candidate{TextEncoding::cp950, bytes_of_text(bytes, is_big5)},
                              Candidate{TextEncoding::cp932, bytes_of_text(bytes, is_shift_jis)}};
  const auto best = std::max_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return a.fitting < b.fitting;  // The first of equal ones is found.
  });
  if (best->fitting == 0) return std::nullopt;
  if (best->encoding == TextEncoding::gbk || means_something(bytes, best->encoding)) return best->encoding;
  return candidates.front().fitting > 0 ? std::optional(TextEncoding::gbk) : std::nullopt;
}

}  // namespace

TextEncoding guess_encoding(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) return TextEncoding::utf8;
  if (bytes.starts_with("\xFF\xFE")) return TextEncoding::utf16le;
  if (bytes.starts_with("\xFE\xFF")) return TextEncoding::utf16be;
  const auto sample = bytes.substr(0, kGuessedFrom);
  if (sample.find('\0') != std::string_view::npos)
    if (const auto utf16 = utf16_of(sample)) return *utf16;
  if (is_utf8_text(bytes)) return TextEncoding::utf8;
  if (looks_cyrillic(bytes) && means_something(bytes, TextEncoding::cp1251)) return TextEncoding::cp1251;
  if (const auto encoding = east_asian(bytes)) return *encoding;
  return looks_like_dos(bytes) ? TextEncoding::cp850 : TextEncoding::cp1252;
}

}  // namespace servoctl::od
