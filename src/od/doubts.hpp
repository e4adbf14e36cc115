#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl::od {

/// A field of a line of drive data that the manual does not bear out, and the lines of the manual that show
/// it.
struct Mark {
  std::string field;  ///< The column: `default`, `min`, `type`.
  std::vector<std::uint32_t> lines;

  bool operator==(const Mark&) const = default;
};

/// Reads `default 938 3288;min`: fields separated by `;`, each with the lines of the manual behind it. Empty
/// for a field without a name, a line that is no number, a field that appears twice.
std::optional<std::vector<Mark>> parse_marks(std::string_view text);

/// `default (lines 938, 3288), min`: for people.
std::string to_text(const std::vector<Mark>& marks);

/// What a line of drive data says without the manual's backing.
struct Doubts {
  std::vector<Mark> assumed;       ///< The manual does not state it.
  std::vector<Mark> contradicted;  ///< The manual states another value as well: one of them was taken.

  bool about(std::string_view field) const;
  /// `?` assumed, `!` contradicted, `?!` both, or nothing: the column of lists, which have no room for words.
  std::string_view sign() const;
};

}  // namespace servoctl::od
