#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl::cli {

/// A word that may stand at the cursor.
struct Candidate {
  /// What kind of word it is, for lists that stand under headings.
  enum class Group : std::uint8_t { values, commands, options, parameters, objects, places };

  std::string word;
  std::string hint = {};  ///< What it is, shown beside it; may be empty.
  Group group = Group::values;
  bool operator==(const Candidate& other) const { return word == other.word && hint == other.hint; }
};

/// Takes away what begins as `typed` but for the case of its letters, where another is called the same and
/// begins exactly so: `lift` beside `Lift`.
void prefer_exact(std::vector<Candidate>& candidates, std::string_view typed);

/// How far all begin alike, in the letters of the first; ASCII case ignored.
std::string common_beginning(std::span<const Candidate> candidates);

/// What stands for `typed` where any of several may be meant: as far as all begin alike. What was typed stays
/// as it is where they differ in the case of just these letters. Empty where nothing is to be changed.
std::string begun_further(std::span<const Candidate> candidates, std::string_view typed);

/// The words in at most so many rows: with their hints, one below the other, where all fit; else in columns.
/// What is beyond that is counted in the last row.
std::vector<std::string> candidate_rows(std::span<const Candidate> candidates, std::size_t columns,
                                        std::size_t rows);

}  // namespace servoctl::cli
