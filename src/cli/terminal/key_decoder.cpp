#include "cli/terminal/key_decoder.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "base/utf8.hpp"

namespace servoctl::cli {
namespace {

using KeyKind = KeyPress::Kind;

constexpr char kEscapeByte = '\x1B';
constexpr std::string_view kPasteBegins = "\x1B[200~";
constexpr std::string_view kPasteEnds = "\x1B[201~";
/// Of more than this nothing is taken.
constexpr std::size_t kLongestPaste = std::size_t{1} << 20U;
constexpr std::size_t kLongestSequence = 32;

struct NamedSequence {
  std::string_view bytes;
  KeyKind kind;
};
/// xterm, also in application mode, the Linux console, rxvt; Alt as Escape before the key.
constexpr std::array kSequences{NamedSequence{"[A", KeyKind::older},
                                NamedSequence{"OA", KeyKind::older},
                                NamedSequence{"[B", KeyKind::newer},
                                NamedSequence{"OB", KeyKind::newer},
                                NamedSequence{"[C", KeyKind::right},
                                NamedSequence{"OC", KeyKind::right},
                                NamedSequence{"[D", KeyKind::left},
                                NamedSequence{"OD", KeyKind::left},
                                NamedSequence{"[H", KeyKind::home},
                                NamedSequence{"OH", KeyKind::home},
                                NamedSequence{"[1~", KeyKind::home},
                                NamedSequence{"[7~", KeyKind::home},
                                NamedSequence{"[F", KeyKind::end},
                                NamedSequence{"OF", KeyKind::end},
                                NamedSequence{"[4~", KeyKind::end},
                                NamedSequence{"[8~", KeyKind::end},
                                NamedSequence{"[3~", KeyKind::erase_at},
                                NamedSequence{"[1;5C", KeyKind::word_right},
                                NamedSequence{"[1;3C", KeyKind::word_right},
                                NamedSequence{"[1;5D", KeyKind::word_left},
                                NamedSequence{"[1;3D", KeyKind::word_left},
                                NamedSequence{"Oc", KeyKind::word_right},
                                NamedSequence{"Od", KeyKind::word_left},
                                NamedSequence{"f", KeyKind::word_right},
                                NamedSequence{"b", KeyKind::word_left},
                                NamedSequence{"d", KeyKind::cut_word_right},
                                NamedSequence{"\x7F", KeyKind::cut_word_left},
                                NamedSequence{"\x08", KeyKind::cut_word_left},
                                NamedSequence{"<", KeyKind::oldest},
                                NamedSequence{">", KeyKind::newest}};

KeyKind kind_of_control(char byte) {
  switch (byte) {
    case '\r':
    case '\n': return KeyKind::enter;
    case '\t': return KeyKind::tab;
    case '\x7F':
    case '\x08': return KeyKind::erase_before;
    case '\x01': return KeyKind::home;
    case '\x02': return KeyKind::left;
    case '\x04': return KeyKind::end_of_input;
    case '\x05': return KeyKind::end;
    case '\x06': return KeyKind::right;
    case '\x07': return KeyKind::cancel;
    case '\x0B': return KeyKind::cut_to_end;
    case '\x0C': return KeyKind::clear_screen;
    case '\x0E': return KeyKind::newer;
    case '\x10': return KeyKind::older;
    case '\x12': return KeyKind::search_older;
    case '\x13': return KeyKind::search_newer;
    case '\x14': return KeyKind::swap;
    case '\x15': return KeyKind::cut_to_start;
    case '\x17': return KeyKind::cut_word;
    case '\x19': return KeyKind::put_back;
    default: return KeyKind::other;
  }
}

bool is_control(char byte) { return static_cast<unsigned char>(byte) < 0x20 || byte == '\x7F'; }

/// Bytes of the character that begins so.
std::size_t size_by(unsigned char first) {
  return first < 0xC0 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
}

}  // namespace

std::optional<KeyPress> KeyDecoder::take(char byte) {
  if (pasting_) return take_pasted(byte);
  if (!held_.empty()) return held_.front() == kEscapeByte ? take_sequence(byte) : take_character(byte);
  if (byte == kEscapeByte) {
    held_ = byte;
    return std::nullopt;
  }
  if (is_control(byte)) return KeyPress{.kind = kind_of_control(byte), .text = {}};
  return take_character(byte);
}

std::optional<KeyPress> KeyDecoder::take_pasted(char byte) {
  pasted_ += byte;
  if (!std::string_view(pasted_).ends_with(kPasteEnds)) {
    // The rest is of the paste as well: taken for keys, its line ends would run lines.
    if (pasted_.size() > kLongestPaste) {
      pasted_.erase(0, pasted_.size() - kPasteEnds.size());
      too_long_ = true;
    }
    return std::nullopt;
  }
  pasted_.resize(pasted_.size() - kPasteEnds.size());
  if (std::exchange(too_long_, false)) pasted_.clear();
  pasting_ = false;
  return KeyPress{.kind = KeyKind::text, .text = std::exchange(pasted_, {}), .pasted = true};
}

/// A byte that is part of no character is a key that means nothing.
std::optional<KeyPress> KeyDecoder::take_character(char byte) {
  if (!held_.empty() && (static_cast<unsigned char>(byte) & 0xC0U) != 0x80) {
    held_.clear();
    return take(byte);
  }
  held_ += byte;
  if (held_.size() < size_by(static_cast<unsigned char>(held_.front()))) return std::nullopt;
  const auto text = std::exchange(held_, {});
  const auto point = decode_utf8(text);
  if (!point.value || is_hidden_or_control(*point.value)) return KeyPress{};
  return KeyPress{.kind = KeyKind::text, .text = text};
}

std::optional<KeyPress> KeyDecoder::take_sequence(char byte) {
  held_ += byte;
  if (held_.size() == 2) {
    if (byte == '[' || byte == 'O') return std::nullopt;
    if (byte == kEscapeByte) {  // Escape twice: the second may begin a key.
      held_ = byte;
      return std::nullopt;
    }
    return end_sequence();
  }
  // ECMA-48, 5.4: parameters and intermediates, and one byte from @ to ~ that ends it.
  const bool goes_on = byte >= 0x20 && byte < 0x40;
  if (goes_on && held_.size() < kLongestSequence) return std::nullopt;
  return end_sequence();
}

KeyPress KeyDecoder::end_sequence() {
  const auto bytes = std::exchange(held_, {});
  if (bytes == kPasteBegins) {
    pasting_ = true;
    return {};
  }
  for (const auto& named : kSequences)
    if (std::string_view(bytes).substr(1) == named.bytes) return {.kind = named.kind, .text = {}};
  return {};
}

}  // namespace servoctl::cli
