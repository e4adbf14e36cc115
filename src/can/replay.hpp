#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/bus.hpp"
#include "can/trace.hpp"

namespace servoctl::can {

/// A bus that answers as it did when the file was recorded; any recording that for_each_frame() reads.
/// `place` is the file, and behind `?channel=` the bus that answers where the file has several, behind
/// `?columns=` or `&columns=` what ColumnChoice reads. Time is that of the recording: nobody waits.
/// Errc::file when the file cannot be read, is damaged or holds no frame; Errc::usage where it has frames of
/// several buses and none is named, or none of that one.
///
/// Frames that only masters send (NMT, SDO requests, remote frames, LSS requests) are taken as sent by us:
/// each frame sent must be among them, and what follows them in the recording is received after they were
/// sent. A frame that the recording does not hold is Errc::bus.
Result<std::unique_ptr<Bus>> open_replay(std::string_view place);

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
