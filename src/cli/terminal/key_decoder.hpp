#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace servoctl::cli {

/// One key of a terminal that hands over its bytes as they come.
struct KeyPress {
  enum class Kind : std::uint8_t {
    text,  ///< A character, or all that was pasted.
    enter,
    end_of_input,
    tab,
    cancel,
    erase_before,
    erase_at,
    left,
    right,
    word_left,
    word_right,
    home,
    end,
    older,
    newer,
    oldest,
    newest,
    cut_to_end,
    cut_to_start,
    cut_word,  ///< Back to a blank.
    cut_word_left,
    cut_word_right,
    put_back,
    swap,
    clear_screen,
    search_older,
    search_newer,
    other,  ///< One that means nothing here.
  };
  Kind kind = Kind::other;
  std::string text;
  bool pasted = false;
};

/// Makes keys of bytes, whatever pieces they come in: characters of UTF-8, sequences of xterm and those like
/// it, and what stands between the marks of a paste (DECSET 2004).
class KeyDecoder {
 public:
  /// Takes in one byte; the key that ends with it.
  std::optional<KeyPress> take(char byte);
  /// Whether a key, or a paste, has begun and not ended.
  bool is_inside() const { return pasting_ || !held_.empty(); }

 private:
  std::optional<KeyPress> take_pasted(char byte);
  std::optional<KeyPress> take_character(char byte);
  std::optional<KeyPress> take_sequence(char byte);
  KeyPress end_sequence();

  std::string held_;  ///< Of a key that has not ended.
  std::string pasted_;
  bool pasting_ = false;
  bool too_long_ = false;  ///< The paste, to be taken.
};

}  // namespace servoctl::cli
