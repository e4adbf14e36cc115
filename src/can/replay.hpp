#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/bus.hpp"
#include "can/trace.hpp"

namespace servoctl::can {

/// A bus that answers as it did when `file` was recorded; any recording that for_each_frame() reads. Time is
/// that of the recording: nobody waits. Errc::file when the file cannot be read, is damaged or holds no
/// frame.
///
/// Frames that only masters send (NMT, SDO requests, remote frames, LSS requests) are taken as sent by us:
/// each frame sent must be among them, and what follows them in the recording is received after they were
/// sent. A frame that the recording does not hold is Errc::bus.
Result<std::unique_ptr<Bus>> open_replay(const std::filesystem::path& file);

/// See open_replay().
class ReplayBus final : public Bus {
 public:
  /// `lines` in rising time, at least one; `name` is used in messages.
  ReplayBus(std::vector<LogFrame> lines, std::string name);

  TimePoint now() const override { return now_; }
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;

 private:
  void skip_done();

  std::vector<LogFrame> lines_;
  std::vector<bool> done_;  ///< Sent by us, or received.
  std::size_t next_ = 0;    ///< The first line that is not done.
  std::string name_;
  TimePoint now_;
};

}  // namespace servoctl::can
