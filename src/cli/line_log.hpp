#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "can/descriptor.hpp"

namespace servoctl::cli {

/// A file in which all that is typed and answered stands, each line with the time when it began (UTC,
/// milliseconds): behind
/// `> ` what was typed, behind two blanks what was answered. Each line has left the program as soon as it is
/// whole. Nothing waits for it: it is a regular file, and once it takes no more, it is given up.
class LineLog {
 public:
  /// Goes on behind what is in the file. Errc::file where it cannot be written, or is no regular file.
  static Result<std::unique_ptr<LineLog>> open(const std::filesystem::path& file);

  LineLog(const LineLog&) = delete;
  LineLog& operator=(const LineLog&) = delete;
  ~LineLog();

  const std::string& name() const { return name_; }
  void typed(std::string_view line);
  void answered(std::string_view text);
  /// Why nothing more is written; told once.
  std::optional<Error> take_failure();

 private:
  LineLog(can::Descriptor file, std::string name) : file_(std::move(file)), name_(std::move(name)) {}
  void end_line();
  void put(std::string_view time, std::string_view mark, std::string_view line);

  can::Descriptor file_;
  std::string name_;
  std::string begun_;     ///< Of a line that is answered piece by piece.
  std::string begun_at_;  ///< When its first piece came.
  std::optional<Error> failure_;
};

}  // namespace servoctl::cli
