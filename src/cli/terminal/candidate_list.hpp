#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace servoctl::cli {

/// A word that may stand at the cursor.
struct Candidate {
  std::string word;
  std::string hint = {};  ///< What it is, shown beside it; may be empty.
  bool operator==(const Candidate&) const = default;
};

/// How far all begin alike, in the letters of the first; ASCII case ignored.
std::string common_beginning(std::span<const Candidate> candidates);

/// The words in at most so many rows: with their hints, one below the other, where all fit; else in columns.
/// What is beyond that is counted in the last row.
std::vector<std::string> candidate_rows(std::span<const Candidate> candidates, std::size_t columns,
                                        std::size_t rows);

}  // namespace servoctl::cli
