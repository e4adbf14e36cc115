#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/bus.hpp"
#include "can/frame.hpp"
#include "can/trace_file.hpp"

namespace servoctl::can {

/// What the times in a trace count from.
enum class TraceClock {
  wall,  ///< 1970-01-01 UTC, as candump does; steps of the system clock during the trace are not followed.
  bus,   ///< Zero of the bus's own now(): for simulated buses.
};

/// What such times are ahead of a clock that shows `now`. Taken once, so that a step of the system clock does
/// not tear the trace apart.
Duration trace_offset(TraceClock clock, TimePoint now);

/// A bus that passes everything on to `inner` and writes every frame, sent and received, to `file` in the
/// form of `candump -L`, which canplayer and log2asc read: `(1736412345.123456) can0 601#4041600000000000`.
/// As TraceFile, also in its errors, while the bus is in use as next_event() asks for; without a trace the
/// bus goes on.
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
  TraceBus(std::unique_ptr<Bus> inner, TraceFile file, std::string interface_name, Duration clock_offset);

  TimePoint now() const override { return inner_->now(); }
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;
  Result<void> recover(TimePoint deadline) override { return inner_->recover(deadline); }
  Result<void> leave_for(std::uint32_t bitrate) override { return inner_->leave_for(bitrate); }
  std::string about() const override { return inner_->about(); }
  TimePoint arrived() const override { return inner_->arrived(); }
  void gather(Duration delay) override { inner_->gather(delay); }
  int poll_fd() const override { return inner_->poll_fd(); }
  TimePoint next_event() const override;
  std::vector<Message> take_notices() override;
  std::uint64_t fd_frames() const override { return inner_->fd_frames(); }
  void flush_trace() override { file_.flush(now()); }
  /// The bus is left before the reader is waited for: nobody waits for servoctl there.
  void end_trace() override {
    inner_.reset();
    file_.end();
  }

 private:
  void record(const Frame& frame, TimePoint time);

  TraceFile file_;
  std::unique_ptr<Bus> inner_;
  std::string interface_name_;
  Duration clock_offset_;  ///< From the bus's clock to the times in the file.
};

}  // namespace servoctl::can
