#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/bus.hpp"
#include "can/foreign_clock.hpp"
#include "can/serial_port.hpp"
#include "can/slcan_codec.hpp"
#include "can/slcan_opening.hpp"
#include "can/slcan_place.hpp"

namespace servoctl::can {

/// Opens an adapter of the LAWICEL protocol: `/dev/ttyACM0@1M`, see parse_slcan_place(). Errors as there, and
/// of SerialPort::open(); Errc::bus where nothing answers as an adapter does, or it refuses the bitrate;
/// Errc::interrupted by a signal.
Result<std::unique_ptr<Bus>> open_slcan(std::string_view place,
                                        SlcanOpening::Mode mode = SlcanOpening::Mode::normal);

/// A bus behind such an adapter, closed with C in the end. A frame counts as sent when the adapter has
/// acknowledged it; one that it refuses, because its queue is full, is offered again for a second.
/// Where its firmware acknowledges nothing, a frame counts as sent when the port has taken it.
class SlcanBus final : public Bus {
 public:
  /// Between two questions for the status flags (CAN232 manual: not faster than twice a second).
  static constexpr Duration kFlagsEvery = std::chrono::seconds(1);

  SlcanBus(SlcanPlace place, SlcanOpening::Mode mode) : place_(std::move(place)), mode_(mode) {}
  ~SlcanBus() override;

  /// As open_slcan(). `limit` ends it early; kNever: as long as the rounds of SlcanOpening take. A signal
  /// ends it only where `ends_by_signal`.
  Result<void> open(TimePoint limit, bool ends_by_signal);

  TimePoint now() const override { return steady_now(); }
  /// Errc::bug for a frame that is not one of ISO 11898-1.
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;
  Result<void> recover(TimePoint deadline) override;
  TimePoint arrived() const override { return arrived_; }
  int poll_fd() const override { return port_ ? port_->get() : -1; }
  std::vector<std::string> take_notices() override;
  TimePoint next_event() const override;

 private:
  enum class Answer : std::uint8_t { none, acknowledged, refused };
  struct Received {
    Frame frame;
    TimePoint time;
  };

  Result<void> hand_shake(TimePoint limit, bool ends_by_signal);
  Result<void> judge(const SlcanOpening& opening) const;
  Result<void> write(std::string_view text, TimePoint limit);
  Result<void> fill();
  void on_line(const SlcanLine& line, TimePoint time);
  Result<Answer> answer_to_frame(TimePoint limit);
  Result<Answer> wait_for_answer(TimePoint limit);
  Result<Answer> wait_for_version(TimePoint limit);
  Result<Answer> wait_while(const std::function<bool()>& missing, TimePoint limit);
  void on_answer(Answer answer, bool has_letter);
  void wait_for_flags();
  void miss_flags();
  Result<void> ask_for_flags();
  void close();
  tl::unexpected<Error> lose(Error error);

  SlcanPlace place_;
  SlcanOpening::Mode mode_;
  std::optional<SerialPort> port_;
  std::optional<Error> lost_;  ///< Why there is no port any more.
  SlcanReader reader_;
  ForeignClock stamps_{std::chrono::minutes(1)};
  bool acknowledges_ = false;
  bool acknowledges_frames_ = true;  ///< Until the first one is not; again when one is.
  bool frame_was_acknowledged_ = false;
  std::string version_;
  bool version_came_ = false;     ///< Since it was set back.
  Answer answer_ = Answer::none;  ///< To the frame that was sent last.
  bool is_offering_ = false;      ///< That answer is waited for.
  bool knows_flags_ = false;
  std::optional<TimePoint> flags_asked_;  ///< While their answer is out.
  TimePoint flags_due_ = kNever;
  bool flags_are_old_ = true;
  int flags_missed_ = 0;          ///< Questions without an answer, in succession.
  std::size_t damaged_ = 0;       ///< Lines since they were last told.
  std::size_t unanswered_ = 0;    ///< Frames whose acknowledge was lost; the same.
  std::size_t refused_late_ = 0;  ///< Frames that nobody waited for any more; the same.
  std::deque<Received> inbox_;
  TimePoint arrived_{};
};

}  // namespace servoctl::can
