#include "cli/words.hpp"

#include <algorithm>

#include "base/format.hpp"

namespace servoctl::cli {
namespace {

class Splitter {
 public:
  Splitter(std::string_view line, const VariableLookup& variables) : line_(line), variables_(variables) {}

  Result<std::vector<std::string>> split() {
    for (at_ = 0; at_ < line_.size() && !comment_; ++at_)
      if (const auto taken = take(line_[at_]); !taken) return fail(taken.error());
    if (quote_ == '\0') return std::move(words_);
    return fail(Errc::usage, message("the quote {} is not closed", quote_),
                message("close it, or write \\{}", quote_));
  }

 private:
  Result<void> take(char c) {
    if (quote_ == '\0' && (c == ' ' || c == '\t' || c == '\r' || c == '\n')) {
      in_word_ = false;
      return {};
    }
    if (!in_word_ && quote_ == '\0') {
      comment_ = c == '#';
      if (comment_) return {};
      words_.emplace_back();
      in_word_ = true;
    }
    return take_in_word(c);
  }

  Result<void> take_in_word(char c) {
    const bool more = at_ + 1 < line_.size();
    if (c == quote_) {
      quote_ = '\0';
    } else if (quote_ == '\0' && (c == '"' || c == '\'')) {
      quote_ = c;
    } else if (c == '\\' && quote_ != '\'' && more) {
      words_.back() += line_[++at_];
    } else if (quote_ != '\'' && variables_.begins(line_, at_)) {
      const auto value = variables_.take(line_, at_);
      if (!value) return fail(value.error());
      words_.back() += *value;
    } else {
      words_.back() += c;
    }
    return {};
  }

  std::string_view line_;
  VariableExpansion variables_;
  std::vector<std::string> words_;
  std::size_t at_ = 0;
  bool in_word_ = false;
  bool comment_ = false;
  char quote_ = '\0';
};

bool needs_quotes(const std::string& word) {
  return word.empty() || word.front() == '#' || word.find_first_of(" \t\r\n\"'\\") != std::string::npos ||
         word.find("${") != std::string::npos;
}

}  // namespace

Result<std::vector<std::string>> split_words(std::string_view line, const VariableLookup& variables) {
  return Splitter(line, variables).split();
}

Result<std::string> VariableExpansion::take(std::string_view line, std::size_t& at) {
  const auto end = line.find('}', at);
  if (end == std::string_view::npos)
    return fail(Errc::usage, "the brace of ${ is not closed", "write ${NAME}, or \\${ for the characters");
  const auto name = line.substr(at + 2, end - at - 2);
  at = end;
  auto value = (*variables_)(name);
  if (value) filled_in_ += value->size();
  if (filled_in_ > kLongestLine)
    return fail(Errc::usage, message("its variables make the line longer than {} MiB", kLongestLine >> 20U),
                "is a variable too long?");
  return value;
}

std::string join_words(std::span<const std::string> words) {
  std::string out;
  for (const auto& word : words) {
    if (&word != &words.front()) out += ' ';
    if (!needs_quotes(word)) {
      out += word;
      continue;
    }
    out += '"';
    for (const char c : word) {
      if (c == '"' || c == '\\' || c == '$') out += '\\';
      out += c;
    }
    out += '"';
  }
  return out;
}

}  // namespace servoctl::cli
