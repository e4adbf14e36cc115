#pragma once

#include <span>
#include <string>
#include <string_view>

#include "command/command.hpp"

namespace servoctl::command {

/// One of the words that only make sense where several lines follow each other: `use`, `drive`, `bus`,
/// `undo`, `log`, `exit`. What they do stands in cli/.
struct PromptWord {
  std::string_view name;
  std::string_view argument;  ///< `NODE`; empty: takes none.
  std::string_view summary;   ///< One line, no full stop.
  std::string_view details;   ///< More for `help WORD`.
  std::span<const Example> examples;
  bool is_place = false;  ///< It says where the following lines go; in batch files, too.
};
std::span<const PromptWord> prompt_words();

/// Null where there is none; `quit` is `exit`.
const PromptWord* find_prompt_word(std::string_view name);

/// `use NODE`: how the word is written.
std::string prompt_usage(const PromptWord& word);

}  // namespace servoctl::command
