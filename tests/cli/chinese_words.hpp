#pragma once

#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "golden_cases.hpp"

/// What is English in a line that Chinese readers see.
namespace servoctl::cli {

/// tests/cli/chinese_exceptions.txt: words that stay, and parts of lines that do.
struct Exceptions {
  std::set<std::string> words;
  std::vector<std::string> parts;
};

/// Of a line all words in front of its reason.
inline const Exceptions& exceptions() {
  static const Exceptions all = [] {
    Exceptions out;
    std::ifstream file(golden_source() / "tests/cli/chinese_exceptions.txt");
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line.front() == '#') continue;
      const auto text = line.substr(0, line.find("  # "));
      constexpr std::string_view kPart = "part: ";
      if (text.starts_with(kPart)) {
        out.parts.push_back(text.substr(kPart.size()));
        continue;
      }
      for (const auto word : split(std::string_view(text), ' ')) out.words.emplace(word);
    }
    const auto add = [&](std::string_view text) {
      for (const auto word : split(text, ' ')) out.words.emplace(word);
    };
    for (const auto* command : command::registry()) {
      add(command->path);
      for (const auto& parameter : command->parameters)
        for (const auto choice : parameter.choices) add(choice);
    }
    for (const auto& option : command::global_options())
      for (const auto choice : option.choices) add(choice);
    for (const auto& word : command::prompt_words()) add(word.name);
    return out;
  }();
  return all;
}

/// A word of English: small letters, the first perhaps a capital, hyphens within.
inline bool is_english_word(std::string_view word) {
  static const std::regex kWord("[A-Za-z]?[a-z]{2,}([-'][a-z]+)*");
  return std::regex_match(word.begin(), word.end(), kWord) &&
         exceptions().words.count(std::string(word)) == 0;
}

/// Words of English in the line, outside of quotes, backticks and command lines.
inline std::vector<std::string> english_words(std::string line) {
  static const std::regex kept("`[^`]*`|'[^']*'|\"[^\"]*\"|“[^”]*”");
  for (const auto& part : exceptions().parts)
    if (line.find(part) != std::string::npos) return {};
  for (const auto* command : command::registry())
    for (const auto& example : command->examples)
      // `man` stands in other words.
      if (const auto at = line.find(example.line);
          at != std::string::npos && std::string_view(example.line).find(' ') != std::string_view::npos)
        line.erase(at, std::string_view(example.line).size());
  line = std::regex_replace(line, kept, " # ");
  std::vector<std::string> out;
  std::string word;
  const auto end = [&] {
    constexpr std::string_view kMarks = ".,;:?!()[]{}<>|=*";
    const auto first = word.find_first_not_of(kMarks);
    if (first != std::string::npos) {
      const auto bare = word.substr(first, word.find_last_not_of(kMarks) + 1 - first);
      if (is_english_word(bare)) out.push_back(bare);
    }
    word.clear();
  };
  for (const char c : line) {
    if (c == ' ' || static_cast<unsigned char>(c) >= 0x80)
      end();
    else
      word += c;
  }
  end();
  return out;
}

inline std::set<std::string> english_lines(const std::string& said) {
  std::set<std::string> out;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("$ ") || line.starts_with("{") || line.starts_with("[exit")) continue;
    const auto words = english_words(line);
    if (words.empty()) continue;
    std::string found;
    for (const auto& word : words) append(found, word, " ");
    out.insert(found + "  in  " + line);
  }
  return out;
}

}  // namespace servoctl::cli
