#include "command/completion_words.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/printable.hpp"
#include "base/text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"

namespace servoctl::command {

bool can_be_offered(std::string_view name) {
  constexpr std::string_view kOwnMeaning = " \"#$&'()*;<>?[\\]^`{|}~!";
  return !name.empty() && name.front() != '-' && name.find_first_of(kOwnMeaning) == std::string_view::npos &&
         printable(name) == name;
}

std::string shell_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string options_of(std::span<const Parameter> parameters, bool with_value_only) {
  std::string out;
  for (const auto& p : parameters) {
    if (!p.name.starts_with("-") || (with_value_only && p.kind == Kind::flag)) continue;
    append(out, std::string(p.name), " ");
    if (with_value_only && !p.short_name.empty()) out += " " + std::string(p.short_name);
  }
  return out;
}

std::string first_words() {
  std::string out;
  std::string last;
  for (const auto* command : registry()) {
    const auto word = std::string(split(command->path, ' ').front());
    if (word != last) append(out, word, " ");
    last = word;
  }
  return out;
}

std::string second_words(std::string_view first) {
  std::string out;
  for (const auto* command : registry()) {
    const auto parts = split(command->path, ' ');
    if (parts.size() > 1 && parts.front() == first) append(out, std::string(parts[1]), " ");
  }
  return out;
}

namespace {

/// Those that are not the first word of a command as well.
std::string prompt_words_alone() {
  std::string out;
  for (const auto& word : prompt_words())
    if (second_words(word.name).empty() && find_command(word.name) == nullptr)
      out += " " + std::string(word.name);
  return out;
}

}  // namespace

std::string all_value_options() {
  auto out = options_of(global_options(), true);
  for (const auto* command : registry())
    if (const auto own = options_of(command->parameters, true); !own.empty())
      for (const auto word : split(own, ' '))
        if ((" " + out + " ").find(" " + std::string(word) + " ") == std::string::npos)
          out += " " + std::string(word);
  return out;
}

std::string source_of(const Parameter& p) {
  if (!p.choices.empty()) {
    return fmt::format("={}", fmt::join(p.choices, " "));
  }
  switch (p.kind) {
    case Kind::object: return "objects";
    case Kind::parameter: return "parameters";
    case Kind::family: return "families";
    case Kind::topic: return "topics";
    case Kind::bus: return "buses";
    case Kind::file: return "files";
    case Kind::nodes: return "=all";
    case Kind::command: return "=" + first_words() + prompt_words_alone();
    default: return "none";
  }
}

}  // namespace servoctl::command
