#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drive/everyday_words.hpp"

namespace servoctl::show {

/// The words that somebody typed, and what else people say for them.
class SaidWords {
 public:
  /// `everyday` outlives it.
  SaidWords(std::string_view typed, std::span<const drive::EverydayWords> everyday);

  /// Folded; a number behind Chinese is a word of its own, and so is what is before and behind a `=`.
  const std::vector<std::string>& all() const { return all_; }
  /// Whether all words stand in a text that is searchable(); where something has several names, one of them.
  bool are_in(std::string_view text) const;
  /// What all that was typed is a name of; null where it is more, or nothing of that kind.
  const drive::EverydayWords* thing() const { return thing_; }

 private:
  void find_things(std::span<const drive::EverydayWords> everyday);

  std::vector<std::string> all_;
  std::vector<const drive::EverydayWords*> things_;
  std::vector<std::string> rest_;  ///< Words that name none of the things.
  const drive::EverydayWords* thing_ = nullptr;
};

}  // namespace servoctl::show
