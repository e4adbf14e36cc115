#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl::cli {

/// A line while it is typed, character by character: what is combined with a character goes with it. The
/// cursor stands before one of them, or behind the last.
class EditedLine {
 public:
  std::string text() const { return joined(0, characters_.size()); }
  std::string before_cursor() const { return joined(0, cursor_); }
  const std::vector<std::string>& characters() const { return characters_; }
  std::size_t cursor() const { return cursor_; }
  bool empty() const { return characters_.empty(); }

  /// The cursor behind it.
  void set(std::string_view text);
  /// At the cursor. What would move the cursor of a terminal, or hides, is left out; a tab is a blank.
  void insert(std::string_view text);
  /// `bytes` of text before the cursor, whole characters of it, give way to this.
  void replace_before(std::size_t bytes, std::string_view text);

  void erase_before();
  void erase_at();
  void left();
  void right();
  void home() { cursor_ = 0; }
  void end() { cursor_ = characters_.size(); }
  void word_left() { cursor_ = word_start(); }
  void word_right() { cursor_ = word_end(); }
  void swap();

  /// What is cut is kept for put_back().
  void cut_to_end() { cut(cursor_, characters_.size()); }
  void cut_to_start() { cut(0, cursor_); }
  void cut_word();
  void cut_word_left() { cut(word_start(), cursor_); }
  void cut_word_right() { cut(cursor_, word_end()); }
  void put_back() { insert(cut_); }

 private:
  std::string joined(std::size_t from, std::size_t to) const;
  std::size_t word_start() const;
  std::size_t word_end() const;
  void cut(std::size_t from, std::size_t to);

  std::vector<std::string> characters_;
  std::size_t cursor_ = 0;
  std::string cut_;
};

}  // namespace servoctl::cli
