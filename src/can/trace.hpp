#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/bus.hpp"
#include "can/descriptor.hpp"
#include "can/frame.hpp"

namespace servoctl::can {

/// What the times in a trace count from.
enum class TraceClock {
  wall,  ///< 1970-01-01 UTC, as candump does; steps of the system clock during the trace are not followed.
  bus,   ///< Zero of the bus's own now(): for simulated buses.
};

/// Called with why a trace was not written; Errc::file.
using TraceFailed = std::function<void(const Error& error)>;

/// A bus that passes everything on to `inner` and writes every frame, sent and received, to `file` in the
/// form of `candump -L`, which canplayer and log2asc read: `(1736412345.123456) can0 601#4041600000000000`.
/// An existing file is replaced. A frame reaches the file at most 100 ms late while the bus is in use, as
/// next_event() asks for; flush_trace() and the end of the bus bring what is left. A pipe or terminal that
/// nobody reads is not waited for: a megabyte is kept for it, frames beyond that are left out and counted in
/// take_notices(), and half a second is given to it at the end; `failed` is told the count of all that is
/// missing. Errc::file when the file cannot be made, or is a named pipe that nobody has opened for reading.
/// When it cannot be written later on, `failed` is told, once, and the bus goes on without a trace.
Result<std::unique_ptr<Bus>> trace_to(std::unique_ptr<Bus> inner, const std::filesystem::path& file,
                                      std::string_view interface_name, TraceClock clock = TraceClock::wall,
                                      TraceFailed failed = {});

/// One line of a trace.
struct LogFrame {
  Duration time{};             ///< Since 1970 or since the bus began.
  std::string interface_name;  ///< Such as `can0`.
  Frame frame;
  bool operator==(const LogFrame&) const = default;
};

/// The line in the form of `candump -L`, without the line break. Times are not negative.
std::string to_string(const LogFrame& line);

/// Reads such a line, with or without its line break; what candump appends (`R` or `T`: received, sent) is
/// ignored. Empty for anything else, CAN FD frames included.
std::optional<LogFrame> parse_log_line(std::string_view line);

/// See trace_to().
class TraceBus final : public Bus {
 public:
  TraceBus(std::unique_ptr<Bus> inner, Descriptor file, std::string file_name, std::string interface_name,
           Duration clock_offset, TraceFailed failed);
  ~TraceBus() override;

  TimePoint now() const override { return inner_->now(); }
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;
  Result<void> recover(TimePoint deadline) override { return inner_->recover(deadline); }
  TimePoint arrived() const override { return inner_->arrived(); }
  void gather(Duration delay) override { inner_->gather(delay); }
  int poll_fd() const override { return inner_->poll_fd(); }
  TimePoint next_event() const override;
  std::vector<std::string> take_notices() override;
  void flush_trace() override { flush(); }

 private:
  void record(const Frame& frame, TimePoint time);
  void flush();
  void flush_to_slow_reader();
  void give_up(int error);
  void flush_when_due();
  TimePoint flush_due() const;

  std::unique_ptr<Bus> inner_;
  Descriptor file_;
  std::string file_name_;
  std::string interface_name_;
  Duration clock_offset_;  ///< From the bus's clock to the times in the file.
  std::string buffer_;
  TimePoint oldest_{};        ///< When the first line in the buffer was put there.
  bool stalled_ = false;      ///< The reader had no room when it was asked last.
  std::size_t left_out_ = 0;  ///< Frames since they were last told.
  std::size_t missing_ = 0;   ///< Frames that were told to be left out.
  TraceFailed failed_;
};

}  // namespace servoctl::can
