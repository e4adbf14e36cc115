#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::cli {

/// The lines that were typed at a prompt, oldest first, kept in a file between runs.
class LineHistory {
 public:
  /// Lines that are kept.
  static constexpr std::size_t kMostLines = 2000;

  /// Takes the lines of the file behind those it has; also of one that libedit wrote. Without a file: none.
  void load(const std::filesystem::path& file);
  /// The file as it is now, which another prompt may have written, and behind it what was added here. What is
  /// in it is replaced as a whole. Errc::file.
  Result<void> save(const std::filesystem::path& file) const;

  /// A line that is the same as the one before is not added again.
  void add(std::string_view line);
  std::size_t size() const { return lines_.size(); }
  const std::string& at(std::size_t i) const { return lines_[i]; }

  /// The place of the last line before `before` that holds the text; upper and lower case, full and half
  /// width are the same (folded()).
  std::optional<std::size_t> find_older(std::string_view text, std::size_t before) const;
  /// The first one behind `after`.
  std::optional<std::size_t> find_newer(std::string_view text, std::size_t after) const;

 private:
  bool holds(std::size_t i, std::string_view folded_text) const;

  std::vector<std::string> lines_;
  std::vector<std::string> own_;  ///< Those that were added here.
};

}  // namespace servoctl::cli
