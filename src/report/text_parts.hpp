#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// How a text for people is put together: what stands around it, and the parts that it can be taken apart
/// into.
namespace servoctl::report {

/// A text without the blanks and the punctuation at both ends.
struct BareText {
  std::string_view before;
  std::string_view text;
  std::string_view behind;
};
BareText bare(std::string_view text);

/// The punctuation as Chinese writes it: `: ` is `：`; what is none stays.
std::string punctuation_zh(std::string_view marks);

/// What separates parts, the strongest first.
enum class Joint : std::uint8_t { lines, columns, sentences, clauses, colons, dashes, commas, brackets };
constexpr std::size_t kJoints = 8;

struct TextParts {
  std::vector<std::string_view> parts;
  std::vector<std::string_view> joints;  ///< Behind each part; that of the last may be empty.
};

/// The parts of the text; what stands in quotes '…', in backticks, or (but for lines and columns) in brackets
/// is not taken apart. One part where there is no such joint.
TextParts parts_at(std::string_view text, Joint joint);

/// Whether its first two words are in capitals: a sentence of them, not a sign such as `LSS` before a text.
bool begins_in_capitals(std::string_view text);

/// How many words of small letters it holds that may be English: two letters or more, outside quotes and
/// backticks, not part of a name such as `a.csv`, `--yes`, `can0`.
std::size_t small_words(std::string_view text);

}  // namespace servoctl::report
