#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::cli {

/// The variables of a batch file.
class Variables {
 public:
  /// Reads `NAME=VALUE` of the command line: it wins over `set` in the file. Errc::usage when it is none.
  Result<void> fix(std::string_view assignment);
  /// Reads `NAME=VALUE` of the file. Errc::usage when it is none.
  Result<void> set(std::string_view assignment);
  /// The value of a loop's variable, or of a column of its row (`ROW.gain`).
  void assign(std::string name, std::string value) { values_[std::move(name)] = std::move(value); }
  /// Forgets the columns of a row.
  void forget_row(const std::string& name);

  /// Errc::usage with the nearest names when there is none of this name.
  Result<std::string> value(std::string_view name) const;

 private:
  std::map<std::string, std::string, std::less<>> values_;
  std::map<std::string, std::string, std::less<>> fixed_;
};

/// What a loop's variable is in one round: a word, or the columns of a row.
struct LoopItem {
  std::string word;
  std::string name = word;                                      ///< In messages: the word, or `axes.csv:7`.
  std::vector<std::pair<std::string, std::string>> cells = {};  ///< Column and cell; empty for a word.
};

/// The rounds of a loop over these words: `1,3,5-8` stands for its numbers, one word that ends in `.csv` for
/// the lines of the file (beside the batch file, in `folder`), any other word for itself. Errc::usage for a
/// list that runs backwards or never ends, Errc::file for a file that cannot be read or has no line.
Result<std::vector<LoopItem>> loop_items(std::span<const std::string> words,
                                         const std::filesystem::path& folder);

}  // namespace servoctl::cli
