#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::cli {

/// One statement of a batch file; continued lines are one.
struct Statement {
  enum class Kind : std::uint8_t {
    command,  ///< A command line, or one in the form of CiA 309-3.
    set,      ///< set NAME=VALUE …
    loop,     ///< for NAME in LIST … end
    expect,   ///< expect EXPRESSION
    pause,    ///< pause "TEXT"
    wait,     ///< wait TIME
    on_error  ///< on-error stop|continue
  };
  Kind kind = Kind::command;
  std::uint32_t line = 0;            ///< Of the file, from 1: where the statement begins.
  std::string text;                  ///< A command line whole, else what stands behind the word.
  std::string variable = {};         ///< Of a loop.
  std::vector<Statement> body = {};  ///< Of a loop.
};

/// A batch file taken apart: what it says, not what that means.
struct Batch {
  std::vector<Statement> statements;
  std::vector<Error> errors;  ///< All that is wrong with its structure, each with its line.
};

/// Reads a whole file: command lines, `#` comments (a `#!` line is one), `\` at the end of a line, LF or
/// CRLF, an optional byte order mark.
Batch parse_batch(std::string_view text);

/// Whether a line of such a file may begin so, though it is no command.
bool is_batch_word(std::string_view word);

/// Whether a variable may have this name: letters, digits and `_`, no digit first.
bool is_variable_name(std::string_view name);

}  // namespace servoctl::cli
