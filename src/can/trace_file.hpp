#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/descriptor.hpp"

namespace servoctl::can {

/// Called with why a trace was not written; Errc::file.
using TraceFailed = std::function<void(const Error& error)>;

/// The file of a trace, to which records are written as they come. A record reaches it at most 100 ms late,
/// where flush_when_due() is called as flush_due() asks for; flush() and end() bring what is left. A pipe
/// or terminal that nobody reads is not waited for: a megabyte is kept for it, records beyond that are left
/// out and counted in take_notice(), and half a second is given to it by end(); `failed` is told the count
/// of all that is missing. When it cannot be written later on, `failed` is told, once, and no record is taken
/// any more. Reads no clock but in end(). The destructor writes what is left, as far as it is taken at once,
/// and tells nobody.
class TraceFile {
 public:
  /// An existing file is replaced. Errc::file when it cannot be made, or is a named pipe that nobody has
  /// opened for reading.
  static Result<TraceFile> open(const std::filesystem::path& file, TraceFailed failed);

  TraceFile(Descriptor file, std::string name, TraceFailed failed)
      : file_(std::move(file)), name_(std::move(name)), failed_(std::move(failed)) {}
  TraceFile(TraceFile&&) = default;
  TraceFile& operator=(TraceFile&&) = delete;
  ~TraceFile();

  /// Whether records are still taken.
  explicit operator bool() const { return static_cast<bool>(file_); }
  void put(std::string_view record, TimePoint now);
  /// What the file begins with, and which is no record.
  void put_head(std::string_view head, TimePoint now);
  void flush(TimePoint now);
  void flush_when_due(TimePoint now);
  /// Brings what is left to the reader and tells `failed` what is missing; no record is taken after it.
  void end();
  /// kNever while nothing is kept.
  TimePoint flush_due() const;
  /// Records that were left out since the last call, in words.
  std::optional<Message> take_notice();

 private:
  void flush_to_slow_reader();
  void give_up(int error);
  void drop_written(std::size_t bytes);

  Descriptor file_;
  std::string name_;
  std::string buffer_;
  std::size_t head_ = 0;           ///< Bytes in the buffer in front of the first record.
  std::deque<std::size_t> sizes_;  ///< Of the records in the buffer; the first may be written in part.
  TimePoint oldest_{};             ///< When the first record in the buffer was put there.
  bool stalled_ = false;           ///< The reader had no room when it was asked last.
  std::size_t left_out_ = 0;       ///< Records since they were last told.
  std::size_t missing_ = 0;        ///< Records that were told to be left out.
  TraceFailed failed_;
};

}  // namespace servoctl::can
