#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "cli/words.hpp"
#include "report/value.hpp"

/// What `expect` asks of the result of the line before it.
namespace servoctl::cli {

/// One side of a comparison.
struct Operand {
  enum class Kind : std::uint8_t {
    path,    ///< `[0].value`: a part of the result.
    count,   ///< `count`, `count(.events)`: how many elements a list has.
    word,    ///< `400`, `true`, `gsd600`: a number where it is compared with one, else text.
    quoted,  ///< `"operation enabled"`: text.
  };
  Kind kind = Kind::word;
  std::string text;  ///< Path, word, or text without quotes.
};

enum class Comparator : std::uint8_t {
  holds,  ///< No comparison: the value is `true`.
  equal,
  unequal,
  less,
  at_most,
  greater,
  at_least,
  contains
};

struct Comparison {
  Operand left;
  Comparator comparator = Comparator::holds;
  Operand right = {};
};

/// All of them have to hold.
using Expression = std::vector<Comparison>;

/// Reads `[0].value == 400`, `.state == "operation enabled" and .energised != true`, `count >= 2`,
/// `.bits ~ remote`. `${NAME}` is replaced except in single quotes. Errc::usage when it is no expression.
Result<Expression> parse_expression(std::string_view text, const VariableLookup& variables);

/// The expression as parse_expression() reads it, variables filled in.
std::string to_string(const Expression& expression);

/// Whether the expression holds for the result. A field of a list is that field of each of its elements, and
/// has to hold for all of them. Errc::negative with both sides when it does not hold, or when the result has
/// no such part.
Result<void> expect(const Expression& expression, const report::Value& result);

}  // namespace servoctl::cli
