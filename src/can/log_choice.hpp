#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "can/column_choice.hpp"
#include "can/log_columns.hpp"
#include "can/log_formats.hpp"

namespace servoctl::can {

/// What tools write above the frames of how these are written, again where they go on.
struct LogMode {
  std::optional<unsigned> base;
  std::optional<bool> relative;
  std::optional<Duration> day;
};
LogMode read_log_mode(std::string_view line);

/// Finds out by the first lines of a text what recording it is.
class LogChoice {
 public:
  enum class Form : std::uint8_t { none, candump, asc, trc, columns, format };

  explicit LogChoice(const ColumnChoice* columns);

  /// Looks at the next line; true where it can be nothing else any more.
  bool look(std::string_view line);

  Form form() const;
  /// Of the form `columns`.
  const LogColumns& columns() const { return *columns_; }
  std::size_t header() const { return header_; }  ///< Lines up to the one that names the columns.
  /// Of the form `format`, best first.
  std::vector<const LogFormat*> formats() const;
  /// Of the last two forms; what is open in it, the lines do not tell.
  LogNumbers numbers() const;
  /// The base of the identifiers was concluded from the data.
  bool assumed() const;
  /// The base of the data was concluded from the identifiers.
  bool assumed_data() const;
  /// Times of candump count from the line before (`-td`).
  bool relative_candump() const { return candump_back_; }
  std::optional<Duration> day() const { return day_; }

 private:
  struct Candidate {
    LogPattern pattern;
    BaseEvidence evidence;
    std::size_t count = 0;
  };

  bool look_for_mode(std::string_view line);
  bool look_for_candump(std::string_view line);
  bool look_for_columns(std::string_view line);
  bool look_for_formats(std::string_view line);
  const Candidate* best() const;
  LogNumbers numbers_before() const;

  const ColumnChoice* choice_;
  std::size_t lines_ = 0;
  std::size_t misfits_ = 0;  ///< Lines with something in them that fit no format.
  bool asc_ = false;
  bool trc_ = false;
  bool all_semicolons_ = true;
  std::size_t candump_ = 0;
  bool candump_back_ = false;
  Duration candump_time_{};
  std::optional<LogColumns> columns_;
  std::size_t header_ = 0;
  BaseEvidence column_evidence_;
  std::size_t rows_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<std::string_view> cells_;
  LogCells row_;
  unsigned mode_base_ = 0;
  bool mode_relative_ = false;
  std::optional<Duration> day_;
};

/// Whether a line holds nothing that could be a frame: it is blank, a remark or a mode, or has no digit.
bool is_log_remark(std::string_view line);

}  // namespace servoctl::can
