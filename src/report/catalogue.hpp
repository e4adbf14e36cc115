#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/message.hpp"
#include "report/phrase.hpp"
#include "report/po.hpp"

namespace servoctl::report {

/// Names that stand in data and not in the program, and what they are in another language.
using Names = std::unordered_map<std::string, std::string>;

/// Texts that are made in English, and what they are in another language. It does not change once it is made,
/// so that several threads may ask it.
class Catalogue {
 public:
  /// A text with placeholders, and what it is in the other language: a Phrase once it is needed.
  struct Pattern {
    Phrase id;
    std::string text;
  };

  /// Entries without a translation are left out. Blanks and punctuation at both ends do not count: a text is
  /// put together from parts that begin or end with them.
  explicit Catalogue(std::vector<PoEntry> entries);

  /// The text in the other language, as far as there is something for it: the whole of it, else what it says
  /// around names, numbers and other texts, which are put into the other language in turn, else part by part
  /// (lines, sentences, clauses, brackets). Of several that fit, the one that leaves no English, and has the
  /// most letters. What stands in quotes '…' or backticks stays as it is.
  /// A part that is a name in `names` (may be null) is what stands there.
  std::string translated(std::string_view text, const Names* names = nullptr) const;

  /// The whole text, bare; empty where there is none.
  std::string_view whole(std::string_view text) const;
  /// The format string that is this one in the other language, with its placeholders; empty where there is
  /// none.
  std::string_view literal(std::string_view text) const;
  /// Those that may fit, with the most letters first.
  std::vector<const Pattern*> candidates(std::string_view text) const;

 private:
  std::unordered_map<std::string, std::string> whole_;
  std::unordered_map<std::string, std::string> literals_;
  std::vector<Pattern> patterns_;
  /// By the one of their words that the fewest patterns have.
  std::unordered_map<std::string, std::vector<std::size_t>> by_word_;
};

/// The Chinese of the program, read at the first call.
const Catalogue& chinese();

/// What a command says in English, in Chinese.
std::string in_chinese(std::string_view text, const Names* names = nullptr);

/// Puts a message into Chinese: its text by its literal, and what was put together elsewhere part by part.
void put_into_chinese(Message& message, const Names* names = nullptr);

/// A literal of the program in Chinese, with its placeholders; itself where there is none. It takes no time,
/// so that each of many frames may ask.
std::string_view chinese_word(std::string_view english);

}  // namespace servoctl::report
